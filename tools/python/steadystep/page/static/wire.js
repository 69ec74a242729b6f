// What the server is asked for, and what it says.
if (location.hash.length > 1) {
  sessionStorage.setItem("token", location.hash.slice(1));
  history.replaceState(null, "", location.pathname);
}
const token = sessionStorage.getItem("token") ?? "";

async function response(method, path, body) {
  const options = { method, headers: { Authorization: `Bearer ${token}` } };
  if (typeof body === "string") {
    options.body = body;
  } else if (body !== undefined) {
    options.body = JSON.stringify(body);
    options.headers["Content-Type"] = "application/json";
  }
  let said;
  try {
    said = await fetch(path, options);
  } catch {
    throw new Error("the server of this page does not answer");
  }
  if (!said.ok) {
    const reason = await said.json().catch(() => ({ error: said.statusText }));
    throw new Error(reason.error);
  }
  return said;
}

export const get = async (path) => (await response("GET", path)).json();
export const text = async (path) => (await response("GET", path)).text();
export const file = async (path) => (await response("GET", path)).blob();
export const post = async (path, body) => (await response("POST", path, body)).json();

// Calls `hear` with every message, `silence` when there is no server; tries again for ever.
export function listen(hear, silence) {
  const socket = new WebSocket(`ws://${location.host}/api/live?token=${encodeURIComponent(token)}`);
  socket.onmessage = (event) => hear(JSON.parse(event.data));
  socket.onclose = () => {
    silence();
    setTimeout(() => listen(hear, silence), 1000);
  };
}

export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

export const one = (selector, from = document) => from.querySelector(selector);
export const all = (selector, from = document) => [...from.querySelectorAll(selector)];

export function element(tag, properties = {}, ...children) {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...children);
  return made;
}

export const shown = (number) =>
  number === null || number === undefined ? "nan" : String(Number(Number(number).toPrecision(7)));

// Of what changes all the time: four decimals or digits, and no minus before a zero.
export const steady = (number) =>
  (Math.abs(number) < 1 ? number.toFixed(4) : number.toPrecision(5)).replace(/^-(?=[0.]+$)/, "");

let hiding;
export function say(words, bad = false) {
  const message = one("#message");
  message.textContent = words;
  message.className = bad ? "notice bad" : "notice";
  message.hidden = !words;
  clearTimeout(hiding);
  hiding = setTimeout(() => { message.hidden = true; }, bad ? 15000 : 5000);
}

// Runs it, and says what has gone wrong.
export async function tried(work) {
  try {
    return await work();
  } catch (error) {
    say(error.message, true);
    return undefined;
  }
}

// The numbers of a form by their names; what is empty or hidden is left out. Throws what is no number.
export function numbers(form) {
  const values = {};
  for (const input of all("input:not([type=checkbox])", form)) {
    if (input.value.trim() === "" || input.closest("label")?.hidden) continue;
    const number = Number(input.value.replace(",", "."));
    if (!Number.isFinite(number)) {
      input.focus();
      throw new Error(`“${input.value}” is not a number`);
    }
    values[input.name] = number;
  }
  for (const box of all("input[type=checkbox]", form)) values[box.name] = box.checked;
  return values;
}
