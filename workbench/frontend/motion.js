/** Motion on the clock: displacements of markers, rigid motion and moving points of several actors. */
import { floats } from "./linalg.js";

/** Name and value of every entry, whether the wire made an object or a map of it. */
function entries(table) {
  if (!table) return [];
  return table instanceof Map ? [...table] : Object.entries(table);
}

/** A frame between two frames: (1 - share) a + share b. */
function between(values, size, frame, share, out) {
  const a = frame * size;
  const b = a + size;
  if (share === 0 || b >= values.length) {
    out.set(values.subarray(a, b));
    return out;
  }
  for (let i = 0; i < size; i += 1) out[i] = (1 - share) * values[a + i] + share * values[b + i];
  return out;
}

export class Motion {
  /**
   * @param {object} sent {n, rate, start, frames, deform, rigid, points}: the last three hold float32 bytes by
   *   actor: (frames, k, 3) displacements, (frames, 16) matrices, (frames, n, 3) positions
   */
  constructor(sent) {
    this.n = sent?.n ?? 0;
    this.rate = sent?.rate ?? 120;
    this.start = sent?.start ?? 0;
    this.frames = sent?.frames ?? 0;
    this.tracks = [];
    for (const kind of ["deform", "rigid", "points"]) {
      for (const [actor, bytes] of entries(sent?.[kind])) {
        const values = floats(bytes);
        const size = values.length / this.frames;
        this.tracks.push({ kind, actor, values, size, out: new Float32Array(size) });
      }
    }
    /** Frame on show, whole number or between two; -1: none. */
    this.shown = -1;
  }

  /**
   * Frame at a time: the nearest whole one when that is within a thousandth, else between two.
   * @param {number} t seconds
   */
  frameAt(t) {
    const exact = Math.max(0, Math.min(this.frames - 1, (t - this.start) * this.rate));
    const whole = Math.round(exact);
    return Math.abs(exact - whole) < 1e-3 ? whole : exact;
  }

  /**
   * Put the actors of a scene where they are at a time; says whether anything changed.
   * @param {import("./gl_scene.js").Scene} scene
   * @param {number} t seconds
   */
  seek(scene, t) {
    if (!this.frames) return false;
    const frame = this.frameAt(t);
    if (frame === this.shown) return false;
    this.shown = frame;
    const whole = Math.floor(frame);
    for (const { kind, actor, values, size, out } of this.tracks) {
      const found = scene.actors.get(actor);
      if (!found) continue;
      between(values, size, whole, frame - whole, out);
      if (kind === "deform" && size === 3 * found.k) scene.deform(actor, out);
      else if (kind === "rigid") found.rigid = out;
      else if (kind === "points" && size === 3 * found.n) found.setPoints(out);
    }
    return true;
  }
}
