/**
 * The whole utterance in one strip: waveform, phone classes, the window in view, the clock. Drag to seek, drag
 * the window to pan it.
 */

const STRIP = 7;

/** Lowest and highest sample of each of `n` equal stretches: [low0, high0, low1, high1, ...]. */
export function envelope(samples, length, n) {
  const out = new Float32Array(2 * n);
  for (let i = 0; i < n; i += 1) {
    const first = Math.floor((i * length) / n);
    const last = Math.min(samples.length, Math.max(first + 1, Math.floor(((i + 1) * length) / n)));
    let low = 0;
    let high = 0;
    for (let k = first; k < last; k += 1) {
      if (samples[k] < low) low = samples[k];
      if (samples[k] > high) high = samples[k];
    }
    out[2 * i] = low;
    out[2 * i + 1] = high;
  }
  return out;
}

/** The row of `phones` ([start, end, phone, class]) that holds `t`, or undefined. */
export function phoneAt(phones, t) {
  return phones.find(([start, end]) => t >= start && t < end) ?? (t > 0 ? phones.at(-1) : undefined);
}

function drawWave(ctx, { samples, rate, duration }, width, height, colour) {
  const bins = Math.max(1, Math.round(width));
  const wave = envelope(samples, duration * rate, bins);
  const peak = wave.reduce((most, v) => Math.max(most, Math.abs(v)), 1e-3);
  const middle = height / 2;
  ctx.fillStyle = colour;
  for (let x = 0; x < bins; x += 1) {
    const top = middle - (wave[2 * x + 1] / peak) * (middle - 2);
    const bottom = middle - (wave[2 * x] / peak) * (middle - 2);
    ctx.fillRect(x, top, 1, Math.max(1, bottom - top));
  }
}

function drawPhones(ctx, { phones, duration }, width, height, colours) {
  for (const [start, end, , kind] of phones) {
    const x = (start / duration) * width;
    ctx.fillStyle = colours[kind] ?? colours.silence;
    ctx.fillRect(x, height - STRIP, Math.max(1, ((end - start) / duration) * width - 1), STRIP);
  }
}

/**
 * @param clk the session's clock
 * @param {() => {samples, rate, duration, phones}} read
 * @param {() => object} colours the palette of the theme in use
 * @param {{stop: () => void, play: () => void}} player held still while a drag seeks
 */
export class Overview {
  constructor(clk, read, colours, player) {
    Object.assign(this, { clk, read, colours, player, asked: 0, drag: null });
    this.root = document.createElement("div");
    this.root.className = "overview";
    this.canvas = document.createElement("canvas");
    this.window = document.createElement("div");
    this.window.className = "window";
    this.cursor = document.createElement("div");
    this.cursor.className = "cursor";
    this.root.append(this.canvas, this.window, this.cursor);
    Object.assign(this.root, { tabIndex: 0 });
    for (const [key, value] of Object.entries({ role: "slider", "aria-label": "Time", "aria-valuemin": "0" }))
      this.root.setAttribute(key, value);
    this.watch = new ResizeObserver(() => this.ask());
    this.watch.observe(this.root);
    this.listen();
  }

  ask() {
    this.asked ||= requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.asked = 0;
    const [width, height] = [this.root.clientWidth, this.root.clientHeight];
    if (width < 10 || height < 10) return;
    const ratio = globalThis.devicePixelRatio || 1;
    Object.assign(this.canvas, { width: Math.round(width * ratio), height: Math.round(height * ratio) });
    const ctx = this.canvas.getContext("2d");
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    const data = this.read();
    const palette = this.colours();
    if (data.duration > 0) {
      drawWave(ctx, data, width, height - STRIP, palette.nat);
      drawPhones(ctx, data, width, height, palette.classes);
    }
    this.root.setAttribute("aria-valuemax", data.duration.toFixed(3));
    this.moveWindow();
    this.move(this.clk.t);
  }

  x(t) {
    const { duration } = this.read();
    return duration > 0 ? (t / duration) * this.root.clientWidth : 0;
  }

  moveWindow() {
    const { view } = this.clk;
    this.window.hidden = !view;
    if (!view) return;
    this.window.style.left = `${this.x(view[0])}px`;
    this.window.style.width = `${Math.max(2, this.x(view[1]) - this.x(view[0]))}px`;
  }

  move(t) {
    this.cursor.style.transform = `translateX(${this.x(t).toFixed(2)}px)`;
    this.cursor.style.backgroundColor = this.colours().cursor;
    this.root.setAttribute("aria-valuenow", t.toFixed(3));
    this.root.setAttribute("aria-valuetext", `${t.toFixed(3)} seconds`);
  }

  timeOf(event) {
    const box = this.root.getBoundingClientRect();
    const share = (event.clientX - box.left) / Math.max(1, box.width);
    return Math.min(1, Math.max(0, share)) * this.read().duration;
  }

  listen() {
    const { root, clk } = this;
    root.onpointerdown = (event) => {
      if (!(this.read().duration > 0)) return;
      root.setPointerCapture(event.pointerId);
      const t = this.timeOf(event);
      const inside = event.altKey && clk.view && t > clk.view[0] && t < clk.view[1];
      this.drag = inside ? { from: t, view: clk.view } : { playing: clk.playing };
      if (inside) return;
      if (clk.playing) this.player.stop();
      clk.seek(t);
    };
    root.onpointermove = (event) => {
      if (!this.drag) return;
      const t = this.timeOf(event);
      if (!this.drag.view) {
        clk.seek(t);
        return;
      }
      const span = this.drag.view[1] - this.drag.view[0];
      const most = this.read().duration - span;
      const first = Math.min(most, Math.max(0, this.drag.view[0] + t - this.drag.from));
      clk.setView([first, first + span]);
    };
    root.onpointerup = root.onpointercancel = () => {
      if (this.drag?.playing) this.player.play();
      this.drag = null;
    };
    root.onkeydown = (event) => {
      const { duration } = this.read();
      const to = { ArrowLeft: clk.t - 0.01, ArrowRight: clk.t + 0.01, Home: 0, End: duration }[event.key];
      if (to === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      clk.seek(Math.min(duration, Math.max(0, to)));
    };
  }

  close() {
    this.watch.disconnect();
    cancelAnimationFrame(this.asked);
  }
}
