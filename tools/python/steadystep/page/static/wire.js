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
export async function post(path, body) {
  const begin = performance.now(), said = await response("POST", path, body);
  if (complained < begin) say("");
  return said.json();
}

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

let hiding, complained = Infinity; // since when something is said to be wrong
export function say(words, bad = false) {
  complained = bad ? performance.now() : Infinity;
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

// Throws what is none. A comma may be either kind of mark, and a unit another one.
export function number(words) {
  const text = words.trim();
  if (text === "") throw new Error("a number is missing");
  const value = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(text) ? Number(text) : NaN;
  if (!Number.isFinite(value)) {
    throw new Error(`“${text}” is not a number${text.includes(",") ? "; decimals stand behind a point" : ""}`);
  }
  return value;
}

// The numbers of a form by their names; what is empty or hidden is left out. Throws what is no number.
export function numbers(form) {
  const values = {};
  for (const input of all("input:not([type=checkbox])", form)) {
    if (input.value.trim() === "" || input.closest("label")?.hidden) continue;
    try {
      values[input.name] = number(input.value);
    } catch (error) {
      input.focus();
      throw error;
    }
  }
  for (const box of all("input[type=checkbox]", form)) values[box.name] = box.checked;
  return values;
}
