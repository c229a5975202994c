/**
 * One clock per session id: it moves the cursor of every view of that session in the same animation frame.
 * The clocks live on `globalThis`, so that separately loaded modules (one per Panel component, one per
 * notebook cell) share them. Whoever plays sound attaches itself as the master and says what time it is.
 */
const CLOCKS = (globalThis[Symbol.for("vsw.clocks")] ??= new Map());

/**
 * Time in seconds and the views that follow it.
 *
 * Events: "state" (began or stopped playing), "seek" (somebody moved the clock; the master continues from
 * there), "view" (another stretch of time is in view), "key" (a key of the page, for whoever handles it).
 */
class Clock extends EventTarget {
  constructor() {
    super();
    /** Seconds. */
    this.t = 0;
    this.playing = false;
    /** Number of emitted frames; views called with equal `frame` show the same moment. */
    this.frame = 0;
    /** [first, last] second that is in view, or null when all is. */
    this.view = null;
    this.views = new Set();
    this.source = null;
    this.request = 0;
  }

  /**
   * Add a view; it is told the present time at once.
   * @param {(t: number, playing: boolean) => void} view
   * @returns {() => void} removes the view again
   */
  add(view) {
    this.views.add(view);
    view(this.t, this.playing);
    return () => this.views.delete(view);
  }

  /**
   * Begin to run.
   * @param {() => number} source what time it is, in seconds; asked once a frame
   */
  start(source) {
    cancelAnimationFrame(this.request);
    this.source = source;
    this.playing = true;
    this.dispatchEvent(new Event("state"));
    const tick = () => {
      if (!this.playing) return;
      this.request = requestAnimationFrame(tick);
      this.t = this.source();
      this.emit();
    };
    tick();
  }

  /** Stop where the clock is; views are told once more. */
  stop() {
    cancelAnimationFrame(this.request);
    this.source = null;
    if (!this.playing) return;
    this.playing = false;
    this.dispatchEvent(new Event("state"));
    this.emit();
  }

  /**
   * Move the clock.
   * @param {number} t seconds
   */
  seek(t) {
    this.t = t;
    this.dispatchEvent(new Event("seek"));
    this.emit();
  }

  /**
   * Set which stretch of time is in view, for all that zoom together.
   * @param {[number, number] | null} range seconds, or null for all
   */
  setView(range) {
    const [a, b] = range ?? [null, null];
    if ((this.view?.[0] ?? null) === a && (this.view?.[1] ?? null) === b) return;
    this.view = range ? [a, b] : null;
    this.dispatchEvent(new Event("view"));
  }

  /** Tell every view the time; one that fails does not hold up the others. */
  emit() {
    this.frame += 1;
    for (const view of this.views) {
      try {
        view(this.t, this.playing);
      } catch (error) {
        console.error(error);
      }
    }
  }
}

/**
 * The clock of a session; made when it is first asked for.
 * @param {string} id
 * @returns {Clock}
 */
export function clock(id) {
  let found = CLOCKS.get(id);
  if (!found) CLOCKS.set(id, (found = new Clock()));
  return found;
}
