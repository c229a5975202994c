/**
 * Parts of the lane: its curves as arrays, what it says of a point, its list for keyboard and screen reader, its
 * window.
 */
import { toTime } from "./lane_axes.js";

const MIN_SPAN_S = 0.08;

function floats(buffer) {
  if (!buffer?.byteLength) return new Float32Array(0);
  const bytes = buffer instanceof ArrayBuffer ? buffer : buffer.slice().buffer;
  return new Float32Array(bytes);
}

function readBand(band) {
  return { times: floats(band?.times), low: floats(band?.low), high: floats(band?.high) };
}

/** The curves of a model as arrays. */
export function readCurves(model) {
  const c = model.curves;
  return {
    blend: floats(c.blend),
    rate: c.rate ?? 120,
    start: c.start ?? 0,
    recorded: floats(c.recorded),
    recordedRate: c.recorded_rate ?? 25,
    recordedStart: c.recorded_start ?? 0,
    threshold: c.threshold ?? null,
    other: floats(c.other),
    pieces: (c.pieces ?? []).map(({ start, values }) => ({ start, values: floats(values) })),
    band: readBand(model.band),
  };
}

/** The chip of another unit at `x`, if any. */
export function chipAt(state, x) {
  return state.chips?.find((c) => x >= c.x && x <= c.x + c.w);
}

function joinText(join) {
  const { ratio, percentile, other } = join;
  let place = "peak acceleration unknown";
  if (ratio !== null) {
    const below = percentile === null ? "" : `, above ${percentile.toFixed(0)} % of them`;
    place = `peak acceleration ${ratio.toFixed(2)} × the 95th percentile of natural stretches${below}`;
    if (other !== null && other !== undefined) place += ` (setting A: ${other.toFixed(2)})`;
  }
  return `join at ${join.phone}, ${join.time.toFixed(3)} s · overlap ${join.overlap.toFixed(3)} s · ${place}`;
}

/** What the lane says of the point (x, y); empty where there is nothing. */
export function tooltipText(state, x, y) {
  const { box, view, score, joins, curves } = state;
  const t = toTime(box, view, x);
  if (x < box.left || x > box.right) return "";
  if (y >= box.phones[0] && y <= box.phones[1]) {
    const phone = score.phones.find(([a, b]) => t >= a && t < b);
    return phone && `${phone[2]} · ${phone[0].toFixed(3)}–${phone[1].toFixed(3)} s · ${phone[3]}`;
  }
  if (y >= box.fragments[0] && y <= box.fragments[1]) {
    const f = score.fragments.find((g) => t >= g.start && t < g.end);
    if (!f) return "";
    const backoff = f.backoff.map((b) => `${b[1]} spoken as ${b[2]}`).join(", ");
    return `${f.id} “${f.text}” · phones ${f.phones} · cost ${f.cost.toFixed(2)}${backoff && ` · ▲ ${backoff}`}`;
  }
  const chip = y >= box.others[0] && y <= box.others[1] && chipAt(state, x);
  if (chip) return `${chip.id}: click to let it speak here`;
  const badge = y >= box.joins[0] && state.badges?.find((b) => x >= b.left && x <= b.left + b.w);
  if (badge) return joinText(joins[badge.index]);
  if (y < box.curve[0] || y > box.curve[1]) return "";
  const at = (values, rate, start) => values[Math.round((t - start) * rate)];
  const now = at(curves.blend, curves.rate, curves.start);
  const was = at(curves.recorded, curves.recordedRate, curves.recordedStart);
  const parts = [`${t.toFixed(3)} s`];
  if (now !== undefined) parts.push(`now ${now.toFixed(1)} mm`);
  if (was !== undefined) parts.push(`recorded ${was.toFixed(1)} mm`);
  return parts.join(" · ");
}

/** The fragments as a list that keyboard and screen reader reach. */
export function buildList(model, select) {
  const list = document.createElement("ol");
  list.className = "vsw-lane-list";
  list.setAttribute("role", "listbox");
  list.setAttribute("aria-label", "Chosen fragments");
  list.tabIndex = 0;
  const draw = () => {
    list.replaceChildren(
      ...model.score.fragments.map((f, index) => {
        const item = document.createElement("li");
        item.setAttribute("role", "option");
        item.id = `vsw-fragment-${index}`;
        item.setAttribute("aria-selected", String(index === model.selected));
        item.textContent =
          `${index + 1}: ${f.id}, “${f.text}”, phones ${f.phones}, ` +
          `${f.start.toFixed(2)} to ${f.end.toFixed(2)} s, cost ${f.cost.toFixed(2)}`;
        item.onclick = () => select(index);
        return item;
      }),
    );
    list.setAttribute("aria-activedescendant", `vsw-fragment-${model.selected}`);
  };
  list.onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    event.preventDefault();
    select(model.selected + step);
  };
  draw();
  return { list, draw };
}

/** Zoom and pan of the window in view; always inside [0, duration]. */
export class Window {
  constructor(duration) {
    this.fit(duration);
  }
  fit(duration) {
    this.duration = Math.max(MIN_SPAN_S, duration);
    this.range = [0, this.duration];
  }
  zoom(factor, about) {
    const [a, b] = this.range;
    const span = Math.min(this.duration, Math.max(MIN_SPAN_S, (b - a) * factor));
    const share = (about - a) / (b - a);
    this.set(about - share * span, span);
  }
  pan(seconds) {
    this.set(this.range[0] + seconds, this.range[1] - this.range[0]);
  }
  set(start, span) {
    const held = Math.min(this.duration, Math.max(MIN_SPAN_S, span));
    const first = Math.min(Math.max(0, start), this.duration - held);
    this.range = [first, first + held];
  }
  /** The window as the clock tells it: null when all is in view. */
  get shared() {
    return this.range[1] - this.range[0] > this.duration - 1e-6 ? null : this.range;
  }
}
