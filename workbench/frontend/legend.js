/** What the colours of a mesh view mean: a bar of colours with title, units and numbers, for each set of scalars. */
import { octets } from "./linalg.js";

const BAR_PX = 132;

/** Round numbers in a range, about `n` of them, its ends not among them. */
export function ticks(low, high, n = 4) {
  const raw = (high - low) / n;
  if (!(raw > 0)) return [];
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((k) => k * power >= raw);
  const found = [];
  const margin = 0.09 * (high - low);
  for (let k = Math.ceil((low + margin) / step); k * step <= high - margin; k += 1) found.push(k * step);
  return found;
}

/** A number as short as its place in the range allows. */
export function label(value, low, high) {
  const span = Math.abs(high - low) || Math.abs(value) || 1;
  const digits = Math.max(0, Math.min(8, 2 - Math.floor(Math.log10(span))));
  return Number(value.toFixed(digits)).toString().replace("-", "\u2212");
}

function element(parent, style, text = "") {
  const made = document.createElement("div");
  made.style.cssText = style;
  made.textContent = text;
  parent.append(made);
  return made;
}

/** Colours of the range, lowest first, as a list for a gradient. */
function stops(table) {
  const rgba = octets(table);
  const out = [];
  for (let i = 4; i < rgba.length - 8; i += 4) out.push(`rgb(${rgba[i]} ${rgba[i + 1]} ${rgba[i + 2]})`);
  return out;
}

function drawBar(box, { title, range, table, log }) {
  const [low, high] = range;
  const shown = (v) => (log ? label(10 ** v, 0, 10 ** v) : label(v, low, high));
  const group = element(box, "margin-top:10px;text-align:right");
  group.className = "vsw-legend";
  group.setAttribute("role", "img");
  group.setAttribute("aria-label", `Colours: ${title || "scalars"}, ${shown(low)} to ${shown(high)}`);
  element(group, "margin-bottom:6px;font-weight:600;max-width:150px", title);
  const scale = element(group, `position:relative;height:${BAR_PX}px;margin-left:auto;width:12px`);
  scale.style.background = `linear-gradient(to top, ${stops(table).join(",")})`;
  scale.style.outline = "1px solid color-mix(in srgb, currentColor 35%, transparent)";
  for (const value of [low, ...ticks(low, high), high]) {
    const at = high > low ? (value - low) / (high - low) : 0.5;
    const tick = element(scale, "position:absolute;right:17px;white-space:nowrap;line-height:12px", shown(value));
    tick.style.bottom = `${at * BAR_PX - 6}px`;
  }
}

export class Legend {
  /** @param {HTMLElement} box what the view stands in */
  constructor(box) {
    this.box = element(
      box,
      "position:absolute;right:12px;bottom:12px;pointer-events:none;font:11px/14px var(--vsw-font, sans-serif);" +
        "font-variant-numeric:tabular-nums",
    );
    this.key = "";
  }

  /**
   * Show what the visible actors are coloured by; equal ones once.
   * @param {Iterable<object>} actors
   * @param {number[]} ground red, green, blue behind it
   */
  show(actors, ground) {
    this.box.style.color = 0.3 * ground[0] + 0.6 * ground[1] + 0.1 * ground[2] > 0.5 ? "#171c22" : "#e6eaee";
    const bars = new Map();
    for (const { visible, scalars } of actors) {
      if (!visible || !scalars?.legend) continue;
      const key = JSON.stringify([scalars.title, scalars.range, scalars.log, stops(scalars.table)]);
      bars.set(key, scalars);
    }
    const key = [...bars.keys()].join();
    if (key === this.key) return;
    this.key = key;
    this.box.replaceChildren();
    for (const scalars of bars.values()) drawBar(this.box, scalars);
  }
}
