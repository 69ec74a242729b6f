// The page: views, state, and what its buttons do.
import { all, download, element, file, get, listen, numbers, one, post, say, shown, steady, tried } from "./wire.js";
import { Captured, Live, boxes } from "./plots.js";
import { Settings } from "./settings.js";

const STATES = {
  "SWITCH ON DISABLED": ["off", "", "The bridge is open, the rotor is free."],
  "READY TO SWITCH ON": ["off", "", "The bridge is open, the drive may be switched on."],
  "SWITCHED ON": ["held", "warn", "The rotor is held; no motion is accepted yet."],
  "OPERATION ENABLED": ["ready", "good", "The rotor is held, or moves."],
  "QUICK STOP ACTIVE": ["stopped", "warn", "The rotor is held. Enable to go on."],
  "FAULT": ["fault", "bad", "The bridge is open."],
};
const KNOBS = [
  ["Supply sags to 8 V", "plant.bus_V = 8", "24 V", "plant.bus_V = 24"],
  ["Rotor is jammed", "jam = true", "free", "jam = false"],
  ["Lead of phase a breaks", 'open_phase = "a"', "joined", 'open_phase = "a", open = false'],
  ["Lead of phase b breaks", 'open_phase = "b"', "joined", 'open_phase = "b", open = false'],
  ["Current sensor a sticks", 'stuck_adc = "current_a"', "sound", 'stuck_adc = "current_a", stuck = false'],
  ["Short circuit, 30 A", 'short_circuit = "A+", short_circuit_A = 30'],
  ["Load vibrates, 40 Hz", "load_vibration_Nm = 0.05, load_vibration_Hz = 40", "rest", "load_vibration_Nm = 0, load_vibration_Hz = 40"],
  ["Bridge at 120 °C", "plant.bridge_temperature_C = 120", "25 °C", "plant.bridge_temperature_C = 25"],
  ["Supply fails and returns", 'command = "power-cycle"'],
];
const VIEWS = ["operate", "captures", "settings", "simulation", "guide"];

const act = (action, values) => tried(async () => {
  await post(`/api/act/${action}`, values);
  return true;
});

function view(name) {
  for (const other of VIEWS) one(`#${other}`).hidden = other !== name;
  for (const tab of all("nav button")) tab.setAttribute("aria-selected", String(tab.dataset.view === name));
  if ((name === "settings" || name === "guide") && page.settings) tried(() => page.settings.refresh().then(check));
}

function showState(status) {
  const fault = one("#fault");
  all(".of-simulation").forEach((part) => part.tagName !== "SECTION" && (part.hidden = !status.simulated));
  one("nav button[data-view=simulation]").hidden = !status.simulated;
  const [badge, kind, words] = status.lost ? ["no link", "bad", status.lost]
    : STATES[status.state] ?? [status.state.toLowerCase(), "", ""];
  one("#state").textContent = status.moving && badge === "ready" ? "moving" : badge;
  one("#state").className = `badge ${kind}`;
  one("#state-words").textContent = status.doing ? `${status.doing} …` : words;
  fault.hidden = !status.fault;
  if (status.fault && fault.dataset.name !== status.fault.name) { // is read out once
    fault.replaceChildren(element("strong", { textContent: status.fault.name }),
      ` – ${status.fault.cause}. What to do: ${status.fault.remedy}.`);
  }
  fault.dataset.name = status.fault?.name ?? "";
  one("#reset").disabled = status.state !== "FAULT";
  if (status.lost) return;
  one("#position").textContent = `${steady(status.position_rad)} rad`;
  one("#bus").textContent = `${status.bus_V.toFixed(1)} V`;
  one("#synchronism").textContent = status.synchronism;
  if (status.truth) one("#truth").textContent = `${steady(Number(status.truth.theta_rad))} rad`;
  all(".step-state").forEach((place) => { place.textContent = badge; });
  page.status = status;
}

// By the method, which of its values count; what is left empty stays as the drive has it.
function prepareHoming() {
  const form = one("form#home"), said = one("#home-said"), button = one("button", form);
  const method = one("select", form);
  method.onchange = () => all("[data-of]", form).forEach((label) => {
    label.hidden = !label.dataset.of.split(" ").includes(method.value.split("-")[0]);
  });
  method.onchange();
  form.onsubmit = async (event) => {
    event.preventDefault();
    button.disabled = true;
    said.textContent = "homing …";
    try {
      const { torque_percent, ...values } = numbers(form);
      if (torque_percent !== undefined) values.torque_share = torque_percent / 100;
      await post("/api/act/home", { position_rad: 0, ...values, method: method.value });
      said.textContent = `homed: ${method.selectedOptions[0].text}, is at ${shown(values.position_rad ?? 0)} rad`;
    } catch (error) {
      said.textContent = error.message;
    } finally {
      button.disabled = false;
    }
  };
}

function prepareControls() {
  prepareHoming();
  one("#stop").onclick = () => act("stop");
  all("[data-act]").forEach((button) => {
    button.onclick = async () => {
      const words = { store: "stored in the drive", defaults: "the defaults are stored, and in force at the next enable" };
      if (await act(button.dataset.act) && words[button.dataset.act]) say(words[button.dataset.act]);
      if (button.dataset.act === "defaults") tried(() => page.settings.refresh());
    };
  });
  all("[data-jog]").forEach((button) => {
    button.onclick = () => act("move", { position_rad: Number(button.dataset.jog), relative: true });
  });
  const forms = { move: (form) => act("move", numbers(form)), velocity: (form) => act("velocity", numbers(form)),
                  "set-position": (form) => act("set-position", numbers(form)) };
  for (const [name, work] of Object.entries(forms)) {
    const form = one(`form#${name}`);
    form.onsubmit = (event) => {
      event.preventDefault();
      tried(() => work(form));
    };
  }
}

function prepareCaptures(dictionary) {
  const captured = new Captured(dictionary, one("#captured"));
  const chosen = boxes(dictionary, one("#capture-signals"), ["theta_est_rad", "theta_ref_rad", "i_q_A"]);
  const form = one("#capture");
  form.onsubmit = (event) => {
    event.preventDefault();
    tried(async () => {
      const { duration_s, rate_Hz, moves } = numbers(form), button = one("button", form), end = one("#capture-end");
      const move = moves ? numbers(one("form#move")) : null;
      button.disabled = true;
      end.hidden = false;
      one("#capture-said").textContent = "capturing …";
      try {
        const made = await post("/api/capture", { signals: chosen(), duration_s, rate_Hz, move });
        captured.show(made);
        one("#capture-tools").hidden = false;
        if (made.move_refused) say(`captured, but nothing moved: ${made.move_refused}`, true);
        one("#capture-said").textContent = `${made.time_s.length} samples, ${made.rate_Hz.toFixed(0)} Hz`;
      } catch (error) {
        if (error.message !== "the capture has been ended") throw error;
        one("#capture-said").textContent = "ended";
      } finally {
        button.disabled = false;
        end.hidden = true;
        if (one("#capture-said").textContent.startsWith("capturing")) one("#capture-said").textContent = "";
      }
    });
  };
  all("[data-zoom]").forEach((button) => { button.onclick = () => captured.zoom(button.dataset.zoom); });
  all("[data-save]").forEach((button) => {
    button.onclick = () => tried(async () =>
      download(`capture.${button.dataset.save}`, await file(`/api/capture/${captured.number}.${button.dataset.save}`)));
  });
}

function showCapturing(share) {
  const said = one("#capture-said");
  if (said.textContent.startsWith("capturing")) said.textContent = `capturing … ${(100 * share).toFixed(0)} %`;
}

const turn = (line) => tried(async () => {
  const { said } = await post("/api/knob", { line });
  page.knobSaid = `${line}\n${said}\n\n${page.knobSaid ?? ""}`.slice(0, 4000);
  one("#knob-said").textContent = page.knobSaid;
});

function prepareSimulation() {
  for (const [name, line, back, backLine] of KNOBS) {
    const place = element("div", {}, element("button", { textContent: name, title: line, onclick: () => turn(line) }));
    if (back) place.append(element("button", { textContent: back, title: backLine, onclick: () => turn(backLine) }));
    one("#knobs").append(place);
  }
  all("[data-knob]").forEach((button) => { button.onclick = () => turn(button.dataset.knob); });
  one("#load").onsubmit = (event) => {
    event.preventDefault();
    tried(() => {
      const { load_torque_Nm = 0, ramp_s = 0 } = numbers(one("#load"));
      return turn(`load_torque_Nm = ${load_torque_Nm}, ramp_s = ${ramp_s}`);
    });
  };
  one("#knob").onsubmit = (event) => {
    event.preventDefault();
    turn(one("#knob input").value);
  };
}

const pairs = (list, entries) => list.replaceChildren(...entries.map(([name, value]) =>
  element("div", {}, element("dt", { textContent: name }), element("dd", { textContent: value }))));

// What the second step of the guide shows.
function check() {
  const { values } = page.settings;
  pairs(one("#check-values"), [
    ["supply that is set", `${shown(values.supply_V)} V`],
    ["supply that is measured", page.status ? `${page.status.bus_V.toFixed(1)} V` : "–"],
    ["current limit", `${shown(values.current_limit_A)} A`], ["rated current", `${shown(values.rated_current_A)} A`],
  ]);
}

function prepareGuide(dictionary) {
  const select = one("#motor"), search = one("#motor-search");
  const unit = Object.fromEntries(dictionary.settings.map((setting) => [setting.name, setting.unit]));
  const show = () => {
    const motor = dictionary.motors.find((one) => one.name === select.value);
    pairs(one("#motor-values"), Object.entries(motor?.settings ?? {}).map(([name, value]) =>
      [name, `${shown(value)} ${unit[name]}`]));
  };
  const fill = () => {
    const wanted = search.value.toLowerCase();
    select.replaceChildren(...dictionary.motors
      .filter((motor) => `${motor.name} ${motor.description}`.toLowerCase().includes(wanted))
      .map((motor) => new Option(`${motor.name} – ${motor.description}`, motor.name)));
    show();
  };
  search.oninput = fill;
  select.onchange = show;
  fill();
  one("#take-motor").onclick = async () => {
    if (await act("motor", { motor: select.value })) {
      say(`${select.value}: its values act at the next enable; the current limit is its rated current, and what follows ` +
        "from a motor follows this one");
      await tried(() => page.settings.refresh().then(check));
    }
  };
}

function prepareKeys() {
  const names = { operate: "Operate", captures: "Captures", settings: "Settings", simulation: "Simulation", guide: "First run" };
  for (const name of VIEWS) {
    const tab = element("button", { textContent: names[name], onclick: () => view(name) });
    tab.dataset.view = name;
    tab.setAttribute("role", "tab");
    one("nav").append(tab);
  }
  one("nav").onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    const tabs = all("nav button").filter((tab) => !tab.hidden);
    if (step) tabs.at((tabs.indexOf(document.activeElement) + step) % tabs.length).focus();
  };
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") act("stop");
    if (event.key === "/" && !["INPUT", "SELECT", "TEXTAREA"].includes(document.activeElement.tagName)) {
      event.preventDefault();
      view("settings");
      one("#search").focus();
    }
  });
}

// What the keyboard goes to is not hidden behind what stays above.
new ResizeObserver(() => {
  document.documentElement.style.scrollPaddingTop = `${one("header").offsetHeight + 8}px`;
}).observe(one("header"));

const page = {};
prepareKeys();
view("operate");
const dictionary = await tried(() => get("/api/dictionary"));
if (dictionary) {
  page.settings = new Settings(dictionary, one("#groups"));
  page.live = new Live(dictionary, one("#live"));
  prepareControls();
  prepareCaptures(dictionary);
  prepareSimulation();
  prepareGuide(dictionary);
  listen((message) => {
    if (message.status) showState(message.status);
    if ("capturing" in message) showCapturing(message.capturing);
    else page.live.take(message);
  }, () => showState({ lost: "the server of this page does not answer", simulated: page.status?.simulated }));
}
