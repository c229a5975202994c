/**
 * A browser draws about 16 WebGL views of a page and silently drops the oldest beyond that. Views that are out
 * of sight therefore give their context up in time, keeping a picture, and take one again when they are seen.
 */
const LIVE = (globalThis[Symbol.for("vsw.contexts")] ??= new Set());

/** So many may live though some are out of sight; so many in any case. */
const KEPT = 8;
const MOST = 14;

/** The context of one view: given up and taken again, by us or by the browser. */
export class Loan {
  /** @param {import("./mesh_view.js").View} view */
  constructor(view) {
    this.view = view;
    this.inSight = false;
    /** The picture that stands in while the context is given up; null while there is one. */
    this.still = null;
    /** The loss has been told, so that the context may be asked for again. */
    this.told = false;
    this.wanted = false;
  }

  /** The view has a context from now on; others may have to give theirs up. */
  take() {
    LIVE.delete(this);
    LIVE.add(this);
    const others = [...LIVE].filter((loan) => loan !== this);
    for (const other of others.filter((loan) => !loan.inSight)) {
      if (LIVE.size <= KEPT) return;
      other.suspend();
    }
    for (const other of others) {
      if (LIVE.size <= MOST) return;
      if (LIVE.has(other)) other.suspend();
    }
  }

  give() {
    LIVE.delete(this);
  }

  /** Whether the page shows the view just now. */
  seen(inSight) {
    this.inSight = inSight;
    if (inSight) this.resume();
  }

  /** Give the context up for other views; a picture stands in. */
  suspend() {
    const { view } = this;
    this.give();
    if (this.still || view.dead) return;
    view.draw(true);
    this.still = document.createElement("img");
    this.still.style.cssText = "position:absolute;inset:0;width:100%;height:100%";
    this.still.alt = `${view.model.description} (a still picture: click to go on)`;
    if (view.draws) this.still.src = view.canvas.toDataURL();
    this.still.addEventListener("pointerdown", () => this.resume());
    view.box.append(this.still);
    view.lost = true;
    this.loser = view.scene.gl.getExtension("WEBGL_lose_context");
    this.loser?.loseContext();
  }

  /** Take a context again: now, or as soon as the browser allows it. */
  resume() {
    if (!this.still || this.view.dead) return;
    if (this.told) this.loser?.restoreContext();
    else this.wanted = true;
  }

  /** The context is gone: given up, or taken by the browser, which may give it back. */
  lost(event) {
    event.preventDefault();
    this.view.lost = this.told = true;
    this.give();
    if (this.wanted) setTimeout(() => this.resume());
  }

  /** There is a context again, with nothing in it. */
  restored() {
    if (this.view.dead) return;
    this.told = this.wanted = false;
    this.still?.remove();
    this.still = null;
    this.take();
    this.view.rebuild();
  }
}
