// Settings by group, with search.
import { all, download, element, get, number, one, post, say, shown, text, tried } from "./wire.js";

const bound = (limit) => (typeof limit === "object" && limit !== null
  ? (limit.rated === 1 ? "rated" : `${limit.rated} × rated`) : shown(limit));

export class Settings {
  constructor(dictionary, host) {
    this.dictionary = dictionary;
    this.rows = new Map();
    this.groups = new Map();
    for (const setting of dictionary.settings) {
      if (!this.groups.has(setting.group)) {
        const group = element("details", { className: "card", open: this.groups.size === 0 },
          element("summary", { textContent: setting.group }));
        this.groups.set(setting.group, group);
        host.append(group);
      }
      const row = this.row(setting);
      this.rows.set(setting.name, row);
      this.groups.get(setting.group).append(row.root);
    }
    const search = one("#search");
    search.oninput = () => this.search(search.value);
    one("#export").onclick = () => tried(async () =>
      download("drive.toml", new Blob([await text("/api/settings.toml")])));
    one("#take-file").onclick = () => one("#import").click();
    one("#import").onchange = (event) => tried(() => this.load(event.target));
  }

  row(setting) {
    const error = element("div", { className: "error", hidden: true });
    const row = { setting, error };
    row.input = this.input(setting, row);
    const entry = element("div", { className: "entry" }, row.input);
    if (setting.unit) entry.append(element("span", { textContent: setting.unit }));
    if (setting.group !== "Motor") {
      entry.append(element("button", { textContent: "default", title: `back to its default`,
        onclick: () => this.put(row, () => ({ default: true })) }));
    }
    const range = setting.type === "real" || setting.type === "count"
      ? `${bound(setting.least)} … ${bound(setting.most)}` : "";
    row.root = element("div", { className: "setting" },
      element("label", { className: "name", textContent: setting.name, htmlFor: `setting-${setting.name}` }), entry,
      element("div", { className: "meaning" }, element("b", { textContent: range ? `${range} ` : "" }),
        `${setting.meaning}; ${setting.in_motion ? "acts at once" : "acts at the next enable"}`), error);
    row.words = [setting.name, setting.unit, setting.meaning, setting.group].join(" ").toLowerCase();
    return row;
  }

  input(setting, row) {
    const id = `setting-${setting.name}`;
    if (setting.type === "choice") {
      const select = element("select", { id, onchange: () => this.put(row, () => ({ value: select.value })) });
      for (const choice of setting.choices) {
        select.append(element("option", { value: choice.name, textContent: choice.name, title: choice.meaning }));
      }
      return select;
    }
    if (setting.type === "flag") {
      const box = element("input", { id, type: "checkbox", onchange: () => this.put(row, () => ({ value: box.checked })) });
      return box;
    }
    const input = element("input", { id, inputMode: "decimal", spellcheck: false });
    input.oninput = () => { row.typing = true; };
    input.onchange = () => this.put(row, () => ({ value: this.typed(setting, input.value) }));
    input.onkeydown = (event) => {
      if (event.key === "Escape") this.fill(row, row.value);
    };
    return input;
  }

  // Throws what is no number. Of several one may be not given.
  typed(setting, words) {
    if (setting.elements === 1) return number(words);
    return words.split(/[ ;]+/).filter(Boolean).map((word) => (word === "nan" ? null : number(word)));
  }

  fill(row, value) {
    row.value = value;
    row.typing = false;
    if (row.setting.type === "flag") row.input.checked = value;
    else row.input.value = Array.isArray(value) ? value.map(shown).join("  ")
      : row.setting.type === "choice" ? value : shown(value);
    row.input.classList.remove("wrong");
    row.error.hidden = true;
  }

  async refresh() {
    this.values = await get("/api/settings");
    this.fillAll();
  }

  // But for what is being typed.
  fillAll(set) {
    for (const [name, row] of this.rows) {
      if (row === set || !row.typing) this.fill(row, this.values[name]);
    }
  }

  // `wanted` makes what is asked for, or throws what is wrong with it.
  async put(row, wanted) {
    try {
      this.values = await post("/api/settings", { name: row.setting.name, ...wanted() });
      this.fillAll(row);
      say(`${row.setting.name} is set; “Store” keeps it`);
    } catch (error) {
      row.input.classList.add("wrong");
      row.error.textContent = error.message;
      row.error.hidden = false;
      if (row.setting.type === "flag" || row.setting.type === "choice") {
        const { value: before } = row;
        if (row.setting.type === "flag") row.input.checked = before;
        else row.input.value = before;
      }
    }
  }

  async load(input) {
    const [chosen] = input.files;
    if (!chosen) return;
    const changed = await post("/api/settings.toml", await chosen.text());
    input.value = "";
    await this.refresh();
    say(changed.length ? `changed: ${changed.join(", ")}` : "nothing differs");
  }

  search(words) {
    const wanted = words.toLowerCase().split(/\s+/).filter(Boolean);
    for (const row of this.rows.values()) {
      row.root.hidden = !wanted.every((word) => row.words.includes(word));
    }
    for (const group of this.groups.values()) {
      const found = all(".setting", group).some((root) => !root.hidden);
      group.hidden = !found;
      if (wanted.length && found) group.open = true;
    }
  }
}
