/**
 * How fine a picture is drawn, chosen picture by picture: with several samples a pixel for smooth edges, or,
 * where the processor has to draw and something moves, with fewer pixels than the canvas has: a face that
 * moves must rather be quick. A canvas that asks for antialiasing has it always.
 */

const SAMPLES = 4;
/** Pixels drawn for one of the canvas along each side, in a coarse picture. */
export const COARSE = 0.5;
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether the processor draws, in place of a graphics card. */
export function drawnInSoftware(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return SOFTWARE.test(names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
}

/** Frame buffers of some size, made when it is first drawn into or has changed. */
class Target {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    this.width = this.height = 0;
    this.buffers = [];
    this.targets = [];
  }

  /** Take up a size; says whether the frame buffers must be made. */
  resize(width, height) {
    if (width === this.width && height === this.height) return false;
    this.dispose();
    Object.assign(this, { width, height });
    return true;
  }

  /** A frame buffer of render buffers: [attachment, format] each. */
  make(samples, parts) {
    const { gl } = this;
    const target = gl.createFramebuffer();
    this.targets.push(target);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    for (const [attachment, format] of parts) {
      const buffer = gl.createRenderbuffer();
      this.buffers.push(buffer);
      gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, format, this.width, this.height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, attachment, gl.RENDERBUFFER, buffer);
    }
    return target;
  }

  copy(from, to, width, height, filter) {
    const { gl } = this;
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
    gl.blitFramebuffer(0, 0, this.width, this.height, 0, 0, width, height, gl.COLOR_BUFFER_BIT, filter);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  dispose() {
    const { gl } = this;
    for (const buffer of this.buffers) gl.deleteRenderbuffer(buffer);
    for (const target of this.targets) gl.deleteFramebuffer(target);
    this.buffers = [];
    this.targets = [];
    this.width = this.height = 0;
  }
}

/** Several samples a pixel. */
export class SmoothEdges extends Target {
  /** Draw into many samples from now on. */
  begin() {
    const { gl } = this;
    if (this.resize(gl.drawingBufferWidth, gl.drawingBufferHeight)) {
      const samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
      this.one = this.make(0, [[gl.COLOR_ATTACHMENT0, gl.RGBA8]]);
      this.many = this.make(samples, [
        [gl.COLOR_ATTACHMENT0, gl.RGBA8],
        [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24],
      ]);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.many);
    return 1;
  }

  /** Put what was drawn on the canvas: the format may change only where each pixel has one sample. */
  end() {
    const { gl, width, height } = this;
    this.copy(this.many, this.one, width, height, gl.NEAREST);
    this.copy(this.one, null, width, height, gl.NEAREST);
  }
}

/** Fewer pixels than the canvas has. */
export class CoarsePicture extends Target {
  /** Draw coarsely from now on. */
  begin() {
    const { gl } = this;
    const size = [gl.drawingBufferWidth, gl.drawingBufferHeight].map((n) => Math.max(1, Math.round(COARSE * n)));
    if (this.resize(...size)) {
      this.one = this.make(0, [
        [gl.COLOR_ATTACHMENT0, gl.RGBA8],
        [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24],
      ]);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.one);
    return COARSE;
  }

  /** Put what was drawn on the canvas. */
  end() {
    const { gl } = this;
    this.copy(this.one, null, gl.drawingBufferWidth, gl.drawingBufferHeight, gl.LINEAR);
  }
}

/** One pixel of the canvas for each. */
export class PlainPicture {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
  }

  begin() {
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
    return 1;
  }

  end() {}

  dispose() {}
}
