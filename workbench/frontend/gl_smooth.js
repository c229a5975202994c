/**
 * Smooth edges by drawing with several samples a pixel, switched on picture by picture: where the processor
 * has to draw they double the time, and a face that moves must rather be quick. A canvas that asks for
 * antialiasing has it always.
 */

const SAMPLES = 4;
const SOFTWARE = /swiftshader|llvmpipe|softpipe|software|basic render/i;

/** Whether the processor draws, in place of a graphics card. */
export function drawnInSoftware(gl) {
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  return SOFTWARE.test(names ? gl.getParameter(names.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
}

export class SmoothEdges {
  /** @param {WebGL2RenderingContext} gl */
  constructor(gl) {
    this.gl = gl;
    this.width = this.height = 0;
    this.buffers = [];
    /** Many samples a pixel: drawn into. */
    this.many = null;
    /** One sample a pixel: what they come to. */
    this.one = null;
  }

  /** A frame buffer of render buffers: [attachment, format] each. */
  make(samples, parts) {
    const { gl } = this;
    const target = gl.createFramebuffer();
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

  /** Draw into many samples from now on. */
  begin() {
    const { gl } = this;
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    if (width !== this.width || height !== this.height) {
      this.dispose();
      Object.assign(this, { width, height });
      const samples = Math.min(SAMPLES, gl.getParameter(gl.MAX_SAMPLES));
      this.one = this.make(0, [[gl.COLOR_ATTACHMENT0, gl.RGBA8]]);
      this.many = this.make(samples, [
        [gl.COLOR_ATTACHMENT0, gl.RGBA8],
        [gl.DEPTH_ATTACHMENT, gl.DEPTH_COMPONENT24],
      ]);
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.many);
  }

  /** Put what was drawn on the canvas: the format may change only where each pixel has one sample. */
  end() {
    this.copy(this.many, this.one);
    this.copy(this.one, null);
    this.gl.bindFramebuffer(this.gl.FRAMEBUFFER, null);
  }

  copy(from, to) {
    const { gl } = this;
    const area = [0, 0, this.width, this.height];
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, from);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, to);
    gl.blitFramebuffer(...area, ...area, gl.COLOR_BUFFER_BIT, gl.NEAREST);
  }

  dispose() {
    const { gl } = this;
    for (const buffer of this.buffers) gl.deleteRenderbuffer(buffer);
    for (const target of [this.one, this.many]) if (target) gl.deleteFramebuffer(target);
    this.buffers = [];
    this.one = this.many = null;
    this.width = this.height = 0;
  }
}
