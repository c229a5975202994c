/** A mesh view without WebGL2: pictures that the server draws, of the moment on the clock. */
import { Trackball } from "./camera.js";
import { clock } from "./clock.js";

/** While the clock runs, ms from one picture to the next. */
const PAUSE_MS = 250;
/** A picture that has not come by then is given up, ms. */
const PATIENCE_MS = 20000;

const FRAME = "position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:none";
const CAPTION =
  "position:absolute;left:8px;right:8px;bottom:8px;margin:0;font:11px/14px var(--vsw-font, sans-serif);" +
  "color:var(--vsw-ink2)";

export class Stills {
  /**
   * @param {object} model of Panel
   * @param {HTMLElement} box emptied, and filled with the picture and why it is one
   * @param {string} reason why there is no WebGL2
   */
  constructor(model, box, reason) {
    Object.assign(this, { model, box, reason, pictures: 0, asked: 0, again: false, timer: 0 });
    this.picture = document.createElement("img");
    this.picture.style.cssText = FRAME;
    this.picture.tabIndex = 0;
    this.picture.draggable = false;
    this.picture.alt = model.description;
    this.caption = document.createElement("p");
    this.caption.style.cssText = CAPTION;
    this.caption.textContent = `The server draws this, a few pictures a second: ${reason}.`;
    box.replaceChildren(this.picture, this.caption);
    box.vsw = this;
    this.clock = clock(model.session);
    this.trackball = new Trackball(
      this.picture,
      () => (model.home?.position ? structuredClone(model.home) : null),
      () => this.ask(),
      undefined,
      () => model.zoom_limits,
      (event) => !model.wheel_needs_ctrl || event.ctrlKey || event.metaKey,
    );
    this.connect();
    model.send_msg({ type: "unavailable", reason });
    this.off = this.clock.add(() => this.ask());
  }

  connect() {
    const { model } = this;
    this.watch = new ResizeObserver(() => this.ask());
    this.watch.observe(this.box);
    for (const name of ["revision", "motion", "lights", "ground"]) model.on(name, () => this.ask());
    model.on("camera", () => this.forget());
    model.on("theme", () => {
      this.box.dataset.theme = model.theme;
      this.ask();
    });
    model.on("description", () => (this.picture.alt = model.description));
    model.on("msg:custom", (data) => this.message(data));
    model.on("after_render", () => this.ask());
    model.on("remove", () => this.dispose());
  }

  /** Look again as Python says. */
  forget() {
    this.trackball.camera = null;
    this.ask();
  }

  message(data) {
    if (data.type === "picture") this.take(data);
    else if (data.type === "reset_camera") this.trackball.reset();
    else this.ask();
  }

  /** Ask for the present moment: now, or when the picture asked for before has come. */
  ask() {
    const now = performance.now();
    if (this.dead || !this.box.clientWidth || this.refused) return;
    if (this.asked && now - this.asked < PATIENCE_MS) {
      this.again = true;
      return;
    }
    this.asked = now;
    this.again = false;
    const { trackball, box } = this;
    const { clientWidth: width, clientHeight: height } = box;
    this.model.send_msg({ type: "moment", time: this.clock.t, width, height, camera: trackball.camera });
  }

  /** A picture has come, or why there is none. */
  take({ picture, camera, reason }) {
    this.asked = 0;
    if (reason) this.refuse(reason);
    if (!picture) return;
    this.trackball.camera ??= structuredClone(camera);
    const before = this.picture.src;
    this.picture.src = URL.createObjectURL(new Blob([picture], { type: "image/jpeg" }));
    if (before) URL.revokeObjectURL(before);
    this.pictures += 1;
    if (!this.again) return;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.ask(), this.clock.playing ? PAUSE_MS : 0);
  }

  refuse(reason) {
    this.refused = true;
    this.box.textContent = `The 3-D view cannot be shown: ${this.reason}, and the server cannot draw it. ${reason}`;
    this.box.setAttribute("role", "alert");
    this.box.style.cssText += "display:grid;place-content:center;padding:16px;color:var(--vsw-ink2)";
  }

  dispose() {
    this.dead = true;
    this.off();
    clearTimeout(this.timer);
    this.watch.disconnect();
    this.trackball.dispose();
    if (this.picture.src) URL.revokeObjectURL(this.picture.src);
    this.model.send_msg({ type: "gone" });
  }
}
