/**
 * Plays stretches of a sound with exact ends, and lets the clock run on the audio hardware's time.
 *
 * Where there is no usable audio device the clock runs silently on the page's own time, so that the face still
 * moves; `silent` then says why.
 */

const LEAD_S = 0.02;
const RESUME_MS = 1500;

/** @param {ArrayBuffer|Uint8Array} bytes 16-bit little-endian samples @returns {Float32Array} in [-1, 1) */
export function decodePcm(bytes) {
  if (!bytes?.byteLength) return new Float32Array(0);
  const view = bytes instanceof ArrayBuffer ? new Int16Array(bytes) : new Int16Array(bytes.slice().buffer);
  const samples = new Float32Array(view.length);
  for (let i = 0; i < view.length; i += 1) samples[i] = view[i] / 32768;
  return samples;
}

/** Time inside [from, to] after `elapsed` seconds of playing, going round when `loop`. */
export function playedTime(from, to, elapsed, loop) {
  const run = Math.max(0, elapsed);
  if (loop) return from + (run % (to - from));
  return Math.min(to, from + run);
}

export class Sound {
  /** @param clk the session's clock */
  constructor(clk) {
    this.clk = clk;
    this.samples = new Float32Array(0);
    this.rate = 16000;
    this.duration = 0;
    this.silent = "";
    this.context = null;
    this.buffer = null;
    this.node = null;
    this.ticket = 0;
  }

  /** Take another sound; motion longer than the sound is followed by silence. */
  load(samples, rate, duration) {
    this.halt(0);
    this.samples = samples;
    this.rate = rate;
    this.duration = Math.max(duration, samples.length / rate);
    this.buffer = null;
  }

  /** The running audio context, or null where there is none; `silent` then holds the reason. */
  async open() {
    try {
      this.context ??= new AudioContext({ latencyHint: "interactive" });
      if (this.context.state !== "running") {
        const late = new Promise((done) => setTimeout(done, RESUME_MS));
        await Promise.race([this.context.resume(), late]);
      }
      if (this.context.state !== "running") throw new Error("the audio device does not start");
      this.buffer ??= this.fill(this.context);
      this.silent = "";
      return this.context;
    } catch (error) {
      this.silent = error.message;
      return null;
    }
  }

  fill(context) {
    const length = Math.max(1, Math.round(this.duration * this.rate));
    const buffer = context.createBuffer(1, length, this.rate);
    buffer.copyToChannel(this.samples.subarray(0, length), 0);
    return buffer;
  }

  /**
   * Play [from, to) seconds and stop exactly there.
   * @param {{speed: number, loop: boolean}} how
   */
  async play(from, to, how) {
    this.drop();
    const ticket = (this.ticket += 1);
    const context = await this.open();
    if (ticket !== this.ticket || !(to > from)) return;
    if (context) this.start(context, from, to, how);
    else this.startSilent(from, to, how);
  }

  start(context, from, to, { speed, loop }) {
    const node = context.createBufferSource();
    node.buffer = this.buffer;
    node.playbackRate.value = speed;
    node.connect(context.destination);
    const when = context.currentTime + LEAD_S;
    if (loop) {
      Object.assign(node, { loop: true, loopStart: from, loopEnd: to });
      node.start(when, from);
    } else {
      node.start(when, from, to - from);
    }
    node.onended = () => this.halt(to);
    this.node = node;
    const latency = context.outputLatency || context.baseLatency || 0;
    this.clk.start(() => playedTime(from, to, (context.currentTime - latency - when) * speed, loop));
  }

  startSilent(from, to, { speed, loop }) {
    const when = performance.now();
    const ticket = this.ticket;
    this.clk.start(() => {
      const t = playedTime(from, to, ((performance.now() - when) / 1000) * speed, loop);
      if (!loop && t >= to) queueMicrotask(() => ticket === this.ticket && this.halt(to));
      return t;
    });
  }

  /** Play other samples once, beside the clock; what plays now stops. */
  async hear(samples, rate) {
    this.halt();
    const ticket = this.ticket;
    const context = await this.open();
    if (!context || ticket !== this.ticket || !samples.length) return;
    const buffer = context.createBuffer(1, samples.length, rate);
    buffer.copyToChannel(samples, 0);
    this.node = context.createBufferSource();
    this.node.buffer = buffer;
    this.node.connect(context.destination);
    this.node.start();
    this.heard = (this.heard ?? 0) + 1;
  }

  drop() {
    this.ticket += 1;
    if (!this.node) return;
    this.node.onended = null;
    this.node.stop();
    this.node.disconnect();
    this.node = null;
  }

  /** Stop; the clock then stands at `t`, or where it was. */
  halt(t) {
    this.drop();
    this.clk.stop();
    if (t !== undefined && t !== this.clk.t) this.clk.seek(t);
  }

  close() {
    this.drop();
    this.clk.stop();
    this.context?.close();
    this.context = null;
  }
}
