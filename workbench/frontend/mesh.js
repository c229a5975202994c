/**
 * A scene of meshes and points on the shared clock. Motion is sent once and deformed on the GPU; every change
 * that Python sends is acknowledged when it has been drawn, so that Python never sends faster than this draws.
 */
import { Trackball } from "./camera.js";
import { clock } from "./clock.js";
import { Scene } from "./gl_scene.js";
import { floats } from "./linalg.js";
import { Motion } from "./motion.js";

const KEPT_TIMES = 500;
const REST_MS = 180;

function rgb(hex) {
  return [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);
}

/** What one component shows; `canvas.vsw` is this object, for tests and measurements. */
class View {
  constructor(model, canvas) {
    this.model = model;
    this.canvas = canvas;
    this.clock = clock(model.session);
    this.draws = 0;
    this.lost = false;
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
    this.dead = false;
    this.motion = new Motion(null);
    this.scene = new Scene(canvas);
    this.trackball = new Trackball(
      canvas,
      () => this.home(),
      (settled) => this.cameraMoved(settled),
    );
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

  home() {
    const set = this.homeCamera;
    return structuredClone(set?.position ? set : this.scene.fit());
  }

  setActors() {
    this.scene.setActors(this.model.actors);
    this.motion.shown = -1;
    this.motion.seek(this.scene, this.clock.t);
    if (!this.homeCamera?.position) this.trackball.camera = this.home();
    this.ask();
  }

  setCamera() {
    if (this.sending) return;
    this.homeCamera = this.model.camera?.position ? structuredClone(this.model.camera) : null;
    this.trackball.camera = this.home();
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
    this.motion.seek(this.scene, this.clock.t);
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
    const ground = model.ground || model.palettes[model.theme].view;
    this.scene.draw(this.camera, model.lights, rgb(ground), smooth);
    if (!smooth) this.refine();
    if (this.exact) this.scene.finish();
    this.draws += 1;
    this.first ||= performance.now();
    this.acknowledge();
  }

  /** Draw once more with smooth edges when nothing has moved for a while. */
  refine() {
    this.resting = setTimeout(() => (this.clock.playing ? this.refine() : this.draw(true)), REST_MS);
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

  message(data) {
    const actor = this.scene.actors.get(data.actor);
    if (data.type === "points") {
      actor?.setPoints(floats(data.points));
      this.waiting.push({ n: data.n, received: performance.now() });
    }
    if (data.type === "style" && actor) Object.assign(actor, data.values);
    if (data.type === "reset_camera") this.trackball.camera = this.home();
    this.ask();
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

  contextLost(event) {
    event.preventDefault();
    this.lost = true;
  }

  contextRestored() {
    if (this.dead) return;
    this.scene = new Scene(this.canvas);
    this.lost = false;
    this.scene.setActors(this.model.actors);
    this.motion.shown = -1;
    this.motion.seek(this.scene, this.clock.t);
    this.ask();
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
    cancelAnimationFrame(this.asked);
    clearTimeout(this.resting);
    this.trackball.dispose();
    this.scene.dispose();
  }
}

function refuse(box, model, reason) {
  const text = `The 3-D view cannot be shown: ${reason}.`;
  box.textContent = text;
  box.setAttribute("role", "alert");
  box.style.cssText += "display:grid;place-content:center;padding:16px;color:var(--vsw-ink2)";
  model.send_msg({ type: "unavailable", reason });
  return box;
}

/** Panel entry point. */
export function renderMesh({ model, el }) {
  el.style.width = el.style.height = "100%";
  const box = document.createElement("div");
  box.dataset.theme = model.theme;
  box.style.cssText = "position:relative;width:100%;height:100%;overflow:hidden";
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:none";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", model.description);
  box.append(canvas);
  let view;
  try {
    view = new View(model, canvas);
  } catch (error) {
    return refuse(box, model, error.message);
  }
  canvas.vsw = view;
  canvas.addEventListener("webglcontextlost", (event) => view.contextLost(event));
  canvas.addEventListener("webglcontextrestored", () => view.contextRestored());
  const watch = new ResizeObserver(() => view.resize());
  watch.observe(canvas);
  model.on("revision", () => view.setActors());
  model.on("motion", () => view.setMotion());
  model.on("camera", () => view.setCamera());
  for (const name of ["lights", "ground"]) model.on(name, () => view.ask());
  model.on("theme", () => {
    box.dataset.theme = model.theme;
    view.ask();
  });
  model.on("description", () => canvas.setAttribute("aria-label", model.description));
  model.on("msg:custom", (data) => view.message(data));
  model.on("after_render", () => view.resize());
  model.on("remove", () => {
    watch.disconnect();
    view.dispose();
  });
  model.send_msg({ type: "ready" });
  return box;
}
