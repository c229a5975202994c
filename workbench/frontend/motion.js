/** Motion on the clock: displacements of markers, rigid motion and moving points of several actors. */
import { floats } from "./linalg.js";

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

/** Another number for every moment that a scene was put at. */
let stamps = 0;

export class Motion {
  /**
   * @param {object} sent {n, rate, start, frames, tracks: [{kind, actors, values}]}: float32 bytes of kind
   *   "deform": (frames, k, 3) displacements, "rigid": (frames, 16) matrices, "points": (frames, n, 3) positions
   */
  constructor(sent) {
    this.n = sent?.n ?? 0;
    this.rate = sent?.rate ?? 120;
    this.start = sent?.start ?? 0;
    this.frames = sent?.frames ?? 0;
    this.tracks = (sent?.tracks ?? []).map(({ kind, actors, values: bytes }) => {
      const values = floats(bytes);
      const size = values.length / this.frames;
      return { kind, actors, values, size, out: new Float32Array(size) };
    });
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
   * Put the actors of a scene where they are at a time; says whether anything changed. What is hidden stays
   * where it is: `shown` = -1 puts it right when it appears.
   * @param {import("./gl_scene.js").Scene} scene
   * @param {number} t seconds
   */
  seek(scene, t) {
    if (!this.frames) return false;
    const frame = this.frameAt(t);
    if (frame === this.shown) return false;
    this.shown = frame;
    const whole = Math.floor(frame);
    stamps += 1;
    for (const { kind, actors, values, size, out } of this.tracks) {
      between(values, size, whole, frame - whole, out);
      for (const name of actors) {
        const actor = scene.actors.get(name);
        if (!actor?.visible) continue;
        if (kind === "deform") actor.move(out, stamps);
        else if (kind === "rigid") actor.rigid = out;
        else if (size === 3 * actor.n) actor.setPoints(out);
      }
    }
    return true;
  }
}
