// Traces: four that run, and captured ones to zoom into.
import { all, element, one, post, steady, tried } from "./wire.js";

const BACK_S = [10, 8, 6, 4, 2, 0], SPAN_S = 10, GAP_S = 0.5, LATE_S = 0.15, MOST_SAMPLES = 600;
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

function axis(size) {
  return { stroke: colour("--soft"), grid: { stroke: colour("--grid"), width: 1 }, ticks: { stroke: colour("--grid") },
           size, font: "12px system-ui" };
}

// As many decimals as the ticks are apart.
const ticks = (_, splits, axis, space, apart) => {
  let decimals = 0;
  while (decimals < 9 && Math.abs(apart * 10 ** decimals - Math.round(apart * 10 ** decimals)) > 1e-6) decimals++;
  return splits.map((value) => value.toFixed(decimals));
};

const width = (place) => Math.max(200, place.clientWidth);

// Not narrower than noise, so that a signal at rest does not fill its plot.
function range(_, least, most) {
  if (least === null || most === null) return [-1, 1];
  const middle = (least + most) / 2, half = Math.max((most - least) * 0.6, 1e-3 * Math.abs(middle), 1e-3);
  return [middle - half, middle + half];
}

export class Live {
  constructor(dictionary, host) {
    this.offset = Infinity;
    this.panels = [0, 1, 2, 3].map((n) => this.panel(dictionary, host, n));
    this.dictionary = dictionary;
    new ResizeObserver(() => this.panels.forEach((panel) => panel.plot.setSize(
      { width: width(panel.place), height: 170 }))).observe(host);
    requestAnimationFrame(() => this.draw());
  }

  panel(dictionary, host, n) {
    const select = element("select", { ariaLabel: `Signal of trace ${n + 1}` });
    for (const signal of dictionary.signals) select.append(new Option(signal.name, signal.name));
    select.onchange = () => tried(() => post("/api/live", { signals: this.panels.map((one) => one.select.value) }));
    const value = element("output", { textContent: "–" }), unit = element("span", { className: "unit" });
    const place = element("div");
    host.append(element("div", { className: "card" },
      element("div", { className: "plot-head" }, select, unit, value), place));
    const plot = new uPlot({
      width: width(place), height: 170, legend: { show: false }, cursor: { show: false },
      scales: { x: { time: false, auto: false }, y: { range } },
      axes: [{ ...axis(30), splits: () => BACK_S.map((back) => this.now - back),
               values: () => BACK_S.map((back) => (back ? `−${back} s` : "now")) }, { ...axis(66), values: ticks }],
      series: [{}, { stroke: colour(`--trace-${n}`), width: 1.6 }],
    }, [[], []], place);
    return { select, value, unit, place, plot, data: [[], []], changed: true };
  }

  take(message) {
    if (!message.values) return;
    this.panels.forEach((panel, n) => panel.name === message.signals[n] || this.show(panel, message.signals[n]));
    this.offset = Math.min(this.offset, performance.now() / 1000 - message.time_s);
    this.panels.forEach((panel, n) => {
      const [times, values] = panel.data;
      if (message.time_s - times.at(-1) > GAP_S) { // nobody has looked meanwhile
        times.push(message.time_s - 0.001);
        values.push(null);
      }
      times.push(message.time_s);
      values.push(message.values[n] ?? null);
      if (times.length > MOST_SAMPLES) panel.data = [times.slice(-MOST_SAMPLES / 2), values.slice(-MOST_SAMPLES / 2)];
      panel.value.textContent = this.words(panel, message.values[n]);
    });
  }

  show(panel, name) {
    panel.data = [[], []];
    panel.name = panel.select.value = name;
    panel.signal = this.dictionary.signals.find((signal) => signal.name === name);
    panel.unit.textContent = panel.signal?.unit ?? "";
  }

  words(panel, value) {
    if (value === null || value === undefined) return "–";
    return panel.signal?.words?.[value] ?? steady(value);
  }

  // The time runs evenly, however the samples come.
  draw() {
    requestAnimationFrame(() => this.draw());
    if (!Number.isFinite(this.offset) || one("#operate").hidden) return;
    this.now = performance.now() / 1000 - this.offset - LATE_S;
    for (const panel of this.panels) {
      panel.plot.batch(() => {
        panel.plot.setData(panel.data, true);
        panel.plot.setScale("x", { min: this.now - SPAN_S, max: this.now });
      });
    }
  }
}

export class Captured {
  constructor(dictionary, host) {
    Object.assign(this, { dictionary, host, plots: [] });
    new ResizeObserver(() => this.plots.forEach((plot) => plot.setSize(
      { width: width(plot.root.parentElement), height: 260 }))).observe(host);
  }

  // One plot for each unit.
  show(capture) {
    this.plots.forEach((plot) => plot.destroy());
    this.host.replaceChildren();
    this.times = capture.time_s;
    this.number = capture.number;
    const units = Map.groupBy?.(Object.keys(capture.columns), (name) => this.unit(name)) ?? this.grouped(capture);
    this.plots = [...units].map(([unit, names]) => this.plot(capture, unit, names));
  }

  unit(name) {
    return this.dictionary.signals.find((signal) => signal.name === name)?.unit ?? "";
  }

  grouped(capture) {
    const units = new Map();
    for (const name of Object.keys(capture.columns)) {
      units.set(this.unit(name), [...(units.get(this.unit(name)) ?? []), name]);
    }
    return units;
  }

  plot(capture, unit, names) {
    const place = element("div"), legend = element("div", { className: "legend" });
    names.forEach((name, n) => {
      const mark = element("i");
      mark.style.background = colour(`--trace-${n % 4}`);
      legend.append(element("span", {}, mark, name + (unit ? `, ${unit}` : "")));
    });
    this.host.append(element("div", { className: "card" }, legend, place));
    return new uPlot({
      width: width(place), height: 260, legend: { show: false },
      cursor: { sync: { key: "captured" }, drag: { x: true, y: false } },
      scales: { x: { time: false }, y: { range } },
      axes: [{ ...axis(30), values: (_, splits) => splits.map((t) => `${+t.toFixed(4)} s`) }, { ...axis(66), values: ticks }],
      series: [{}, ...names.map((_, n) => ({ stroke: colour(`--trace-${n % 4}`), width: 1.5 }))],
      hooks: { setScale: [(plot, key) => key === "x" && this.follow(plot)] },
    }, [capture.time_s, ...names.map((name) => capture.columns[name])], place);
  }

  // What is zoomed in one is in all.
  follow(moved) {
    const { min, max } = moved.scales.x;
    for (const plot of this.plots) {
      if (plot !== moved && (plot.scales.x.min !== min || plot.scales.x.max !== max)) plot.setScale("x", { min, max });
    }
  }

  zoom(how) {
    if (!this.plots.length) return;
    const first = this.times[0], last = this.times.at(-1);
    let { min, max } = this.plots[0].scales.x;
    const span = max - min;
    if (how === "all") [min, max] = [first, last];
    if (how === "in") [min, max] = [min + span / 4, max - span / 4];
    if (how === "out") [min, max] = [min - span / 2, max + span / 2];
    if (how === "left") [min, max] = [min - span / 4, max - span / 4];
    if (how === "right") [min, max] = [min + span / 4, max + span / 4];
    this.plots[0].setScale("x", { min: Math.max(first, min), max: Math.min(last, max) });
  }
}

export const boxes = (dictionary, host, chosen) => {
  for (const signal of dictionary.signals) {
    const box = element("input", { type: "checkbox", value: signal.name, checked: chosen.includes(signal.name) });
    host.append(element("label", { title: `${signal.meaning}` }, box, ` ${signal.name}`));
  }
  return () => all("input", host).filter((box) => box.checked).map((box) => box.value);
};
