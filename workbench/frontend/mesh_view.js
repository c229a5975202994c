/** One mesh view: scene, camera, clock, motion, and what Python sends and is told. */
import { Trackball } from "./camera.js";
import { clock } from "./clock.js";
import { Loan } from "./contexts.js";
import { Scene } from "./gl_scene.js";
import { Hint } from "./hint.js";
import { Legend } from "./legend.js";
import { floats } from "./linalg.js";
import { Motion } from "./motion.js";
import { pick } from "./pick.js";
import { pressed } from "./pressed.js";

const KEPT_TIMES = 500;
const REST_MS = 180;

function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

/** What one component shows; `canvas.vsw` is this object, for tests and measurements. */
export class View {
  /**
   * @param {object} model of Panel
   * @param {HTMLCanvasElement} canvas
   * @param {HTMLElement} box what the canvas stands in
   */
  constructor(model, canvas, box) {
    this.model = model;
    this.canvas = canvas;
    this.box = box;
    this.clock = clock(model.session);
    this.draws = 0;
    this.lost = false;
    this.dead = false;
    this.ack = 0;
    /** performance.now() of the first picture, which is the time since the page was asked for. */
    this.first = 0;
    /** Wait for the pixels before a time is taken; only measurements do so. */
    this.exact = false;
    /** {n, received, painted}: times of performance.now() of the last changes sent by Python. */
    this.changes = [];
    this.waiting = [];
    this.asked = 0;
    this.resting = 0;
    this.hovering = 0;
    this.motion = new Motion(null);
    this.scene = new Scene(canvas);
    this.legend = new Legend(box);
    this.hint = new Hint(box, "Ctrl + wheel zooms");
    this.trackball = new Trackball(
      canvas,
      () => this.home(),
      (settled) => this.cameraMoved(settled),
      (event) => this.pickAt(event, "picked"),
      () => model.zoom_limits,
      (event) => this.wheelIsMine(event),
    );
    canvas.addEventListener("dblclick", (event) => this.found(event) || this.trackball.reset());
    canvas.addEventListener("pointermove", (event) => this.hover(event));
    this.loan = new Loan(this);
    this.loan.take();
    this.setActors();
    this.setCamera();
    this.setMotion();
    this.off = this.clock.add((t) => this.follow(t));
  }

  /** Frame of the motion on show; -1: none. */
  get shown() {
    return this.motion.shown;
  }

  get camera() {
    return this.trackball.camera;
  }

  get ground() {
    const { model } = this;
    return rgb(model.ground || model.palettes[model.theme].view);
  }

  /** The camera of a reset: the one said to be it, else the one that Python set last, else a look at all. */
  home() {
    const set = this.model.home?.position ? this.model.home : this.homeCamera;
    return structuredClone(set?.position ? set : this.scene.fit());
  }

  setActors() {
    /** What is shown, by name, with every change since: from it a lost scene is made again. */
    this.specs = new Map(this.model.actors.map((spec) => [spec.name, { ...spec }]));
    this.build();
    if (!this.homeCamera?.position) this.trackball.camera = this.home();
  }

  /** Make the scene of the specs, at the time of the clock. */
  build() {
    if (!this.lost) this.scene.setActors(this.specs.values());
    this.reseek();
  }

  /** Put everything where it is now, and draw. */
  reseek() {
    this.motion.shown = -1;
    if (!this.lost) this.motion.seek(this.scene, this.clock.t);
    this.showLegend();
    this.ask();
  }

  showLegend() {
    this.legend.show([...this.specs.values()], this.ground);
  }

  setCamera() {
    if (this.sending) return;
    this.homeCamera = this.model.camera?.position ? structuredClone(this.model.camera) : null;
    this.trackball.camera = structuredClone(this.homeCamera ?? this.home());
    this.ask();
  }

  cameraMoved(settled) {
    this.ask();
    if (!settled) return;
    this.sending = true;
    this.model.camera = structuredClone(this.trackball.camera);
    this.sending = false;
  }

  setMotion() {
    const received = performance.now();
    for (const actor of this.scene.actors.values()) actor.reset();
    this.motion = new Motion(this.model.motion);
    if (!this.lost) this.motion.seek(this.scene, this.clock.t);
    if (this.motion.n) this.waiting.push({ n: this.motion.n, received });
    this.ask();
  }

  follow(t) {
    if (this.lost || !this.motion.seek(this.scene, t)) return;
    if (this.clock.playing) this.draw();
    else this.ask();
  }

  /** Draw in the next frame. */
  ask() {
    this.asked ||= requestAnimationFrame(() => this.draw());
  }

  /** @param {boolean} smooth with smooth edges; where they are slow, only a picture at rest has them */
  draw(smooth = !this.scene.slow) {
    cancelAnimationFrame(this.asked);
    clearTimeout(this.resting);
    this.asked = 0;
    const { canvas, model } = this;
    if (this.dead || this.lost || !canvas.width || !canvas.clientWidth) return;
    this.scene.draw(this.camera, model.lights, this.ground, smooth);
    if (!smooth) this.refine();
    if (this.exact) this.scene.finish();
    this.draws += 1;
    this.first ||= performance.now();
    this.acknowledge();
  }

  /** Draw once more with smooth edges when nothing has moved for a while, and nobody is in the middle of a drag. */
  refine() {
    const moves = () => this.clock.playing || pressed();
    this.resting = setTimeout(() => (moves() ? this.refine() : this.draw(true)), REST_MS);
  }

  acknowledge() {
    if (!this.waiting.length) return;
    const painted = performance.now();
    for (const { n, received } of this.waiting) {
      this.changes.push({ n, received, painted });
      this.ack = Math.max(this.ack, n);
    }
    this.waiting = [];
    this.changes.splice(0, this.changes.length - KEPT_TIMES);
    this.model.send_msg({ type: "ack", n: this.ack });
  }

  /** A message of Python: what it changes is kept in the specs, too. */
  message(data) {
    if (data.type === "add") for (const spec of data.actors) this.add(spec);
    if (data.type === "reset_camera") this.trackball.reset();
    const spec = this.specs.get(data.actor);
    const actor = this.scene.actors.get(data.actor);
    if (data.n) this.waiting.push({ n: data.n, received: performance.now() });
    if (spec && data.type === "points") {
      spec.points = data.points;
      actor?.setPoints(floats(data.points));
    }
    if (spec && data.type === "style") {
      Object.assign(spec, data.values);
      if (actor) Object.assign(actor, data.values);
      this.reseek();
    }
    if (spec && data.type === "scalars") {
      spec.scalars = data.scalars;
      actor?.setScalars(data.scalars);
      this.showLegend();
    }
    this.ask();
  }

  add(spec) {
    this.specs.set(spec.name, { ...spec });
    if (!this.lost) this.scene.add(spec);
    this.reseek();
  }

  /** Tell Python what is under the pointer. */
  pickAt(event, what) {
    if (!this.lost) this.model.send_msg({ type: "pick", what, found: this.found(event) });
  }

  /** What is under the pointer, or null. */
  found(event) {
    if (this.lost) return null;
    const box = this.canvas.getBoundingClientRect();
    const ratio = this.canvas.width / box.width;
    const x = Math.floor((event.clientX - box.left) * ratio) + 0.5;
    const y = this.canvas.height - Math.floor((event.clientY - box.top) * ratio) - 0.5;
    return pick(this.scene, this.camera, x, y);
  }

  /** In a page that scrolls the wheel zooms with Ctrl only; without, it is said how. */
  wheelIsMine(event) {
    if (!this.model.wheel_needs_ctrl || event.ctrlKey || event.metaKey) return true;
    this.hint.show();
    return false;
  }

  /** While hovering is on, at most once a frame and never during a drag. */
  hover(event) {
    if (!this.model.hover || this.trackball.drag) return;
    cancelAnimationFrame(this.hovering);
    this.hovering = requestAnimationFrame(() => this.pickAt(event, "hovered"));
  }

  resize() {
    const { canvas } = this;
    const ratio = globalThis.devicePixelRatio || 1;
    const [w, h] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (!w || !h) return;
    if (canvas.width !== w || canvas.height !== h) {
      canvas.width = w;
      canvas.height = h;
    }
    this.draw();
  }

  /** Begin anew in a context that has nothing in it. */
  rebuild() {
    this.scene = new Scene(this.canvas);
    this.lost = false;
    this.build();
  }

  /** Positions of an actor as the GPU has them: (n, 3). */
  positions(name) {
    return this.scene.actors.get(name).positions();
  }

  /** Draw now and return the pixels (4 bytes each, from the lower left on). */
  pixels() {
    this.draw(true);
    return this.scene.pixels();
  }

  /** Draw now and return a number that changes when any pixel does. */
  hash() {
    let sum = 2166136261;
    for (const byte of this.pixels()) sum = Math.imul(sum ^ byte, 16777619) >>> 0;
    return sum;
  }

  dispose() {
    this.dead = true;
    this.off();
    this.loan.give();
    for (const asked of [this.asked, this.hovering]) cancelAnimationFrame(asked);
    clearTimeout(this.resting);
    this.trackball.dispose();
    this.hint.dispose();
    this.scene.dispose();
  }
}
