// Draws bodies and links with WebGL 2: a picture of the sun's depth for the
// shadows, then what is solid, then what can be seen through.

import { add, lookingAt, normalised, parallel, product, scaled } from "./vectors.js";
import { BODY_VERTEX, FRAGMENT, LINK_VERTEX, ROW, SHADOW_FRAGMENT } from "./shaders.js";
import { STRIDE, buildMesh, prism } from "./meshes.js";

const SHADOW_SIZE = 2048;
const SUN = normalised([-0.35, -0.6, 1.0]);
const KINDS = { grains: 0, apparatus: 1, glass: 2, links: 3 };
const NO_CUT = [0, 0, 0, 1];
const LINK_SIDES = 8;

export class Renderer {
  // `shapes`: those of the grains, then those of the apparatus.
  constructor(canvas, shapes, grains) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false, powerPreference: "high-performance" });
    if (!gl) throw new Error("no WebGL 2");
    this.gl = gl;
    this.canvas = canvas;
    this.grains = grains;
    this.bodies = shapes.length;
    this.body = this.program(BODY_VERTEX, FRAGMENT);
    this.link = this.program(LINK_VERTEX, FRAGMENT);
    this.shade = this.program(BODY_VERTEX, SHADOW_FRAGMENT);
    const mesh = buildMesh(shapes, grains);
    this.ranges = mesh.ranges;
    this.bodyArray = this.arrayOf(mesh.vertices, [[0, 3, 0], [1, 3, 3], [2, 2, 6]], STRIDE);
    const rows = Math.ceil((3 * this.bodies) / ROW);
    this.texels = new Float32Array(4 * ROW * rows);
    this.texture = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32F, ROW, rows);
    this.nearest();
    this.makeShadow();
    this.linkArray = this.arrayOf(prism(LINK_SIDES), [[0, 3, 0]], 3);
    this.linkBuffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, this.linkBuffer);
    [[1, 4, 0], [2, 3, 4], [3, 3, 7]].forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 40, 4 * offset);
      gl.vertexAttribDivisor(place, 1);
    });
    gl.bindVertexArray(null);
    this.links = 0;
  }

  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]].forEach(([type, source]) => {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const said = gl.getAttachedShaders(program).map((s) => gl.getShaderInfoLog(s)).join(" ");
      throw new Error(`the graphics card refuses a program: ${gl.getProgramInfoLog(program)} ${said}`);
    }
    const uniforms = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const { name } = gl.getActiveUniform(program, k);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return { program, uniforms };
  }

  arrayOf(data, attributes, stride) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    attributes.forEach(([place, size, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, size, gl.FLOAT, false, 4 * stride, 4 * offset);
    });
    return array;
  }

  nearest() {
    const gl = this.gl;
    for (const [name, value] of [
      [gl.TEXTURE_MIN_FILTER, gl.NEAREST], [gl.TEXTURE_MAG_FILTER, gl.NEAREST],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE],
    ]) gl.texParameteri(gl.TEXTURE_2D, name, value);
  }

  makeShadow() {
    const gl = this.gl;
    this.shadow = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, this.shadow);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.DEPTH_COMPONENT24, SHADOW_SIZE, SHADOW_SIZE);
    this.nearest();
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);
    this.shadowFrame = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowFrame);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, this.shadow, 0);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  // Place, turn and colour (linear) of a body; `seen` false hides it.
  setBody(n, seen, position, turn, colour, picked) {
    const at = 12 * n, t = this.texels;
    t[at + 3] = seen ? 1 : 0;
    if (!seen) return;
    t[at] = position[0]; t[at + 1] = position[1]; t[at + 2] = position[2];
    t[at + 4] = turn[0]; t[at + 5] = turn[1]; t[at + 6] = turn[2]; t[at + 7] = turn[3];
    t[at + 8] = colour[0]; t[at + 9] = colour[1]; t[at + 10] = colour[2]; t[at + 11] = picked ? 1 : 0;
  }

  // Ten numbers a link: start, radius, end, colour.
  setLinks(numbers) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.linkBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
    this.links = numbers.length / 10;
  }

  // `look`: grains, apparatus (a list), each solid, faint (glass) or hidden; cut, background.
  draw(camera, look) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ROW, this.texels.length / (4 * ROW), gl.RGBA, gl.FLOAT, this.texels);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
    const all = { first: this.ranges[0]?.[0] ?? 0, count: this.grains ? this.ranges[this.grains - 1][0] + this.ranges[this.grains - 1][1] : 0 };
    const solid = look.apparatus.filter((a) => a.how === "solid");
    const light = this.drawShadow(look, all, solid);

    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(...look.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.activeTexture(gl.TEXTURE1);
    gl.bindTexture(gl.TEXTURE_2D, this.shadow);

    this.use(this.body, camera, look, light);
    gl.bindVertexArray(this.bodyArray);
    this.cull(look.cut ? null : gl.BACK);
    this.pass(this.body, KINDS.apparatus, 1);
    for (const { body } of solid) this.drawBody(body);
    if (look.grains === "solid") {
      this.pass(this.body, KINDS.grains, 1);
      gl.drawArrays(gl.TRIANGLES, all.first, all.count);
    }
    if (this.links > 0) {
      this.use(this.link, camera, look, light);
      this.pass(this.link, KINDS.links, 1);
      this.cull(null);
      gl.bindVertexArray(this.linkArray);
      gl.drawArraysInstanced(gl.TRIANGLES, 0, 6 * LINK_SIDES, this.links);
    }
    this.drawThrough(camera, look, light, all);
    gl.bindVertexArray(null);
  }

  drawThrough(camera, look, light, all) {
    const gl = this.gl;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.depthMask(false);
    this.use(this.body, camera, look, light);
    gl.bindVertexArray(this.bodyArray);
    if (look.grains === "faint") {
      this.cull(gl.BACK);
      this.pass(this.body, KINDS.glass, 0.035);
      gl.drawArrays(gl.TRIANGLES, all.first, all.count);
    }
    if (look.picked !== null) {
      // Seen through whatever stands before it.
      this.cull(gl.BACK);
      gl.depthFunc(gl.ALWAYS);
      this.pass(this.body, KINDS.grains, look.grains === "solid" ? 0.22 : 0.85);
      this.drawBody(look.picked);
      gl.depthFunc(gl.LEQUAL);
    }
    this.pass(this.body, KINDS.glass, 0.1);
    const glass = look.apparatus.filter((a) => a.how === "glass");
    // Far sides before near ones.
    for (const side of [gl.FRONT, gl.BACK]) {
      this.cull(side);
      for (const { body } of glass) this.drawBody(body);
    }
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }

  drawShadow(look, all, solid) {
    const gl = this.gl;
    const { centre, radius } = look.scene;
    const light = product(parallel(radius, 0, 4 * radius), lookingAt(add(centre, scaled(SUN, 2 * radius)), centre, [0, 1, 0]));
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.shadowFrame);
    gl.viewport(0, 0, SHADOW_SIZE, SHADOW_SIZE);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(this.shade.program);
    gl.uniform1i(this.shade.uniforms.bodies, 0);
    gl.uniformMatrix4fv(this.shade.uniforms.view, false, light);
    gl.uniform4fv(this.shade.uniforms.cut, look.cut ?? NO_CUT);
    gl.bindVertexArray(this.bodyArray);
    this.cull(null);
    if (look.grains === "solid") gl.drawArrays(gl.TRIANGLES, all.first, all.count);
    for (const { body, shadow } of solid) if (shadow) this.drawBody(body);
    return { matrix: light, texel: (2 * radius) / SHADOW_SIZE };
  }

  use({ program, uniforms }, camera, look, light) {
    const gl = this.gl;
    gl.useProgram(program);
    gl.uniform1i(uniforms.bodies ?? null, 0);
    gl.uniform1i(uniforms.shadow, 1);
    gl.uniformMatrix4fv(uniforms.view, false, camera.matrix);
    gl.uniformMatrix4fv(uniforms.light, false, light.matrix);
    gl.uniform1f(uniforms.texel_m, light.texel);
    gl.uniform3fv(uniforms.eye, camera.eye);
    gl.uniform3fv(uniforms.sun, SUN);
    gl.uniform4fv(uniforms.cut, look.cut ?? NO_CUT);
    gl.uniform3fv(uniforms.line_colour, look.line);
    gl.uniform1f(uniforms.grain_scale, look.scale);
  }

  pass({ uniforms }, kind, opacity) {
    this.gl.uniform1i(uniforms.kind, kind);
    this.gl.uniform1f(uniforms.opacity, opacity);
  }

  cull(side) {
    const gl = this.gl;
    if (side === null) gl.disable(gl.CULL_FACE);
    else {
      gl.enable(gl.CULL_FACE);
      gl.cullFace(side);
    }
  }

  drawBody(n) {
    this.gl.drawArrays(this.gl.TRIANGLES, ...this.ranges[n]);
  }
}
