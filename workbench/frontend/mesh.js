/**
 * A scene of meshes, points and lines on the shared clock. Motion is sent once and deformed on the GPU; every
 * change that Python sends is acknowledged when it has been drawn, so that Python never sends faster than this
 * draws. Without WebGL2 the server draws pictures in its place.
 */
import { hurryOnTouch } from "./comms.js";
import { View } from "./mesh_view.js";
import { Stills } from "./stills.js";

function makeCanvas(model) {
  const canvas = document.createElement("canvas");
  canvas.style.cssText = "position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:none";
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", model.description);
  return canvas;
}

/** Let a view hear of what changes in the browser and in Python. */
function connect(model, canvas, box, view) {
  canvas.addEventListener("webglcontextlost", (event) => view.loan.lost(event));
  canvas.addEventListener("webglcontextrestored", () => view.loan.restored());
  const size = new ResizeObserver(() => view.resize());
  size.observe(canvas);
  const sight = new IntersectionObserver((entries) => view.loan.seen(entries.at(-1).isIntersecting));
  sight.observe(box);
  model.on("revision", () => view.setActors());
  model.on("motion", () => view.setMotion());
  model.on("camera", () => view.setCamera());
  for (const name of ["lights", "ground"]) model.on(name, () => view.reseek());
  model.on("theme", () => {
    box.dataset.theme = model.theme;
    view.reseek();
  });
  model.on("description", () => canvas.setAttribute("aria-label", model.description));
  model.on("msg:custom", (data) => view.message(data));
  model.on("after_render", () => view.resize());
  model.on("remove", () => {
    size.disconnect();
    sight.disconnect();
    view.dispose();
  });
}

/** Panel entry point. */
export function renderMesh({ model, el }) {
  el.style.width = el.style.height = "100%";
  const box = document.createElement("div");
  box.dataset.theme = model.theme;
  box.style.cssText = "position:relative;width:100%;height:100%;overflow:hidden";
  const canvas = makeCanvas(model);
  box.append(canvas);
  let view;
  try {
    view = new View(model, canvas, box);
  } catch (error) {
    new Stills(model, box, error.message);
    return box;
  }
  canvas.vsw = view;
  hurryOnTouch();
  connect(model, canvas, box, view);
  model.send_msg({ type: "ready" });
  return box;
}
