/**
 * The clock's cursor over any Bokeh or HoloViews plot whose x axis is time in seconds: a thin line above the
 * plot, moved by the clock. Bokeh draws nothing anew, and nothing is sent to the server.
 */
import { clock } from "./clock.js";

/** The views of all plots inside a Bokeh view: those that have a frame and an x range. */
export function plotViews(view, found = []) {
  if (view?.frame?.bbox && view.model?.x_range) found.push(view);
  else for (const child of view?.child_views ?? []) plotViews(child, found);
  return found;
}

/** Where time `t` lies across a frame, in px; null when it is out of view. */
export function cursorX(t, { start, end }, { x, width }) {
  const at = x + ((t - start) / (end - start)) * width;
  return at >= x && at <= x + width ? at : null;
}

function makeBar(box, colour) {
  const bar = document.createElement("div");
  bar.className = "vsw-clock-cursor";
  bar.setAttribute("aria-hidden", "true");
  bar.style.cssText =
    "position:absolute;left:-1px;top:0;width:2px;pointer-events:none;z-index:5;will-change:transform";
  bar.style.backgroundColor = colour;
  box.append(bar);
  return bar;
}

/** Panel entry point. */
export function renderClockPane({ model, view }) {
  const box = document.createElement("div");
  box.style.cssText = "position:relative;width:100%;height:100%";
  box.append(model.get_child("object"));
  const clk = clock(model.session);
  const colour = () => model.palettes[model.theme].cursor;
  let bars = [];
  let ranges = new Set();

  const plots = () => plotViews(view.get_child_view(view.model.data.object));
  const place = (t) => {
    const shown = plots();
    while (bars.length < shown.length) bars.push(makeBar(box, colour()));
    const origin = box.getBoundingClientRect();
    bars.forEach((bar, i) => {
      const plot = shown[i];
      const x = plot ? cursorX(t, plot.model.x_range, plot.frame.bbox) : null;
      bar.hidden = x === null;
      bar.style.display = bar.hidden ? "none" : "";
      if (bar.hidden) return;
      const at = plot.el.getBoundingClientRect();
      const top = at.top - origin.top + plot.frame.bbox.y;
      bar.style.height = `${plot.frame.bbox.height}px`;
      bar.style.transform = `translate(${(at.left - origin.left + x).toFixed(2)}px, ${top}px)`;
    });
  };
  const again = () => requestAnimationFrame(() => place(clk.t));
  const follow = () => {
    for (const plot of plots()) {
      const range = plot.model.x_range;
      if (ranges.has(range)) continue;
      ranges.add(range);
      range.change?.connect(again);
    }
    again();
  };

  const off = clk.add(place);
  const watch = new ResizeObserver(follow);
  watch.observe(box);
  model.on("after_render", follow);
  model.on("theme", () => {
    for (const bar of bars) bar.style.backgroundColor = colour();
  });
  box.vsw = { clock: clk, plots, bars: () => bars };
  model.on("remove", () => {
    off();
    watch.disconnect();
    bars = [];
    ranges = new Set();
  });
  return box;
}
