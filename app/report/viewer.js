// SPDX-License-Identifier: BSD-3-Clause
//
// Shows a motion in 3-D, and the answer to it. The page has both as JSON: `answer` as fcl_artic(1) describes it, and
// `motion`: poses of frames at many times, shapes, and bodies, each a shape at a pose in a frame or in the world. All
// positions are relative to motion.center. The part after # of the page's address may set the time and more:
// #t=0.4&theme=dark&view=30,20 (azimuth and elevation, degrees)&play.
'use strict';
(() => {
const $ = (id) => document.getElementById(id);
const answer = JSON.parse($('answer').textContent);
const motion = JSON.parse($('motion').textContent);
const root = document.documentElement;
const BEGIN = answer.t_begin, END = answer.t_end;
const contacts = answer.contacts;

// ------------------------------------------------------------------------------------------------ numbers and arrays

/** The bytes of a text in base 64 as an array of numbers. */
function decoded(text, Numbers) {
  const bytes = atob(text), out = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; ++i) out[i] = bytes.charCodeAt(i);
  return new Numbers(out.buffer);
}
/** A number with so many decimals; no "-0.0000". */
const fixed = (x, decimals) => (Number(x.toFixed(decimals)) + 0).toFixed(decimals);
const shown = (x, digits = 5) => (x === 0 ? '0' : String(Number(x.toPrecision(digits))));
/** Rounded so that a bound stays one. */
function roundedTo(x, digits, round) {
  if (!(x > 0)) return x;
  const unit = 10 ** (Math.floor(Math.log10(x)) + 1 - digits);
  return Number((round(x / unit) * unit).toPrecision(digits));
}
const lowerText = (x) => shown(roundedTo(x, 3, Math.floor), 3), upperText = (x) => shown(roundedTo(x, 3, Math.ceil), 3);
const clamp = (x, low, high) => Math.min(Math.max(x, low), high);

// Vectors are arrays of three, matrices of sixteen numbers by columns.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.sqrt(dot(a, a));
const unit = (a) => times(a, 1 / (norm(a) || 1));

/** The matrix of a pose x, y, z, qx, qy, qz, qw at p[o] and after it. */
function matrixOf(p, o = 0) {
  let [x, y, z, w] = [p[o + 3], p[o + 4], p[o + 5], p[o + 6]];
  const n = Math.hypot(x, y, z, w) || 1;
  x /= n; y /= n; z /= n; w /= n;
  return [1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w), 0,
    2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w), 0,
    2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y), 0,
    p[o], p[o + 1], p[o + 2], 1];
}
function product(a, b) {
  const out = new Array(16);
  for (let c = 0; c < 4; ++c) {
    for (let r = 0; r < 4; ++r) {
      out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    }
  }
  return out;
}
const moved = (m, p) => [0, 1, 2].map((r) => m[r] * p[0] + m[4 + r] * p[1] + m[8 + r] * p[2] + m[12 + r]);
const scaledAt = (p, s) => [s, 0, 0, 0, 0, s, 0, 0, 0, 0, s, 0, p[0], p[1], p[2], 1];
const IDENTITY = scaledAt([0, 0, 0], 1);
/** From here: a point of the answer, as the page draws it. */
const here = (p) => sub(p, motion.center);

/** What an sRGB colour 0xRRGGBB is in linear light. */
function color(hex) {
  return [16, 8, 0].map((shift) => {
    const c = ((hex >> shift) & 255) / 255;
    return c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  });
}

// ------------------------------------------------------------------------------------------------------------ motion

const POSES = decoded(motion.poses, Float32Array), VALUES = decoded(motion.values, Float32Array);
const TIMES = motion.times, FRAMES = motion.frames, DOF = motion.variables.length;

/** The entries of TIMES about t, and how far t is from the first to the second, in [0, 1]. */
function between(t) {
  let low = 0, high = TIMES.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (TIMES[middle] <= t) low = middle; else high = middle;
  }
  const length = TIMES[high] - TIMES[low];
  return [low, high, length > 0 ? clamp((t - TIMES[low]) / length, 0, 1) : 0];
}
/** Matrices of all frames at time t: between two poses, a pose between them. */
function framesAt(t) {
  const [low, high, share] = between(t), out = [];
  for (let f = 0; f < FRAMES; ++f) {
    const a = 7 * (low * FRAMES + f), b = 7 * (high * FRAMES + f);
    let near = 0;
    for (let i = 3; i < 7; ++i) near += POSES[a + i] * POSES[b + i];
    const pose = [];
    for (let i = 0; i < 7; ++i) {
      const end = i >= 3 && near < 0 ? -POSES[b + i] : POSES[b + i];  // a quaternion and its negative are one
      pose.push(POSES[a + i] + share * (end - POSES[a + i]));
    }
    out.push(matrixOf(pose));
  }
  return out;
}
const valueAt = (t, v) => {
  const [low, high, share] = between(t);
  return VALUES[low * DOF + v] * (1 - share) + VALUES[high * DOF + v] * share;
};
const worldOf = (body, frames) => (body.frame === null ? body.local : product(frames[body.frame], body.local));

// ------------------------------------------------------------------------------------------------------------ bodies

// Links in cool colours, the scene in sand: red and amber are left for what touches.
const LINKS = [0x64748B, 0x3F7CAC, 0x5AA9A2, 0x6C83C9, 0x8FB8DE, 0x4C956C, 0x8E7DBE, 0x2F6690, 0x7FB69A];
const OBSTACLES = [0xCFC8BA, 0xC2BBAE, 0xD6D1C7, 0xB9B4A9];
const TOUCHING = 0xE4572E, TOUCHED = 0xF2A93B, MARK = 0xC1121F, BEFORE = 0x4A90D9, AFTER = 0x9A948C;
const WITNESS = 0xD91EA0;  // magenta: where the tolerances let bodies touch

const bodies = motion.bodies.map((body) => ({...body, local: matrixOf(body.pose), visible: true}));
{
  const numbers = new Map();
  let obstacles = 0;
  for (const body of bodies) {
    const still = body.kind === 'obstacle' || body.kind === 'moving obstacle';
    if (!still && !numbers.has(body.name)) numbers.set(body.name, numbers.size);
    body.hex = still ? OBSTACLES[obstacles++ % OBSTACLES.length] : LINKS[numbers.get(body.name) % LINKS.length];
    body.color = color(body.hex);
    body.moves = body.frame !== null;
  }
}
let chosen = 0;  // of the contacts
const contact = () => contacts[chosen] || null;
/** Bodies with their poses, where the tolerances let the chosen contact be; none where it has no witness. */
const witness = () => motion.witnesses[chosen] || [];
/** When the page shows a contact: a witness is one of its t_upper. */
const momentOf = (c) => (c.q_witness ? c.t_upper : c.t_lower);
/** 1 or 2 for a body of the chosen contact, else 0. */
function sideOf(body) {
  const c = contact();
  return !c ? 0 : c.body1.name === body.name ? 1 : c.body2.name === body.name ? 2 : 0;
}

// ------------------------------------------------------------------------------------------------------------ shapes

const CREASE = Math.cos(40 * Math.PI / 180);  // faces that turn less look smooth
const SMOOTH_AT_MOST = 300000;                // triangles

/** Corners and normals of triangles, three of each a triangle; normals are those of smooth surfaces within creases. */
function cornersOf(positions, corners) {
  const n = corners.length, points = new Float32Array(3 * n), normals = new Float32Array(3 * n);
  for (let i = 0; i < n; ++i) points.set(positions.subarray(3 * corners[i], 3 * corners[i] + 3), 3 * i);
  const faces = new Float32Array(n);  // three numbers a face: twice its area along its normal
  for (let i = 0; i < n; i += 3) {
    const at = (k) => points.subarray(3 * (i + k), 3 * (i + k) + 3);
    faces.set(cross(sub(at(1), at(0)), sub(at(2), at(0))), i);
  }
  const smooth = n <= 3 * SMOOTH_AT_MOST;
  const place = smooth ? placesOf(positions) : null, around = [];
  for (let i = 0; smooth && i < n; ++i) (around[place[corners[i]]] ??= []).push(i - i % 3);
  for (let i = 0; i < n; ++i) {
    const own = i - i % 3, face = faces.subarray(own, own + 3), size = norm(face);
    let normal = [face[0], face[1], face[2]];
    for (const other of smooth ? around[place[corners[i]]] : []) {
      const there = faces.subarray(other, other + 3);
      if (other !== own && dot(face, there) > CREASE * size * norm(there)) normal = add(normal, there);
    }
    normals.set(unit(normal), 3 * i);
  }
  return {points, normals};
}
/** Per vertex the first one at its place: files such as STL share none. */
function placesOf(positions) {
  const first = new Map(), out = new Uint32Array(positions.length / 3);
  for (let i = 0; i < out.length; ++i) {
    const key = `${positions[3 * i] + 0},${positions[3 * i + 1] + 0},${positions[3 * i + 2] + 0}`;
    if (!first.has(key)) first.set(key, i);
    out[i] = first.get(key);
  }
  return out;
}
function cube() {
  const positions = [], corners = [];
  for (let c = 0; c < 8; ++c) positions.push(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
  for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]) {
    corners.push(a, b, c, a, c, d);
  }
  return cornersOf(new Float32Array(positions), corners);
}
/** A surface turned about the z axis, of a profile [radius, z] from below. */
function turned(profile, sectors = 24) {
  const positions = [], corners = [];
  for (const [r, z] of profile) {
    for (let s = 0; s < sectors; ++s) {
      positions.push(r * Math.cos(2 * Math.PI * s / sectors), r * Math.sin(2 * Math.PI * s / sectors), z);
    }
  }
  for (let k = 0; k + 1 < profile.length; ++k) {
    for (let s = 0; s < sectors; ++s) {
      const a = k * sectors + s, b = k * sectors + (s + 1) % sectors;
      corners.push(a, b, b + sectors, a, b + sectors, a + sectors);
    }
  }
  return cornersOf(new Float32Array(positions), corners);
}
const ball = () => turned(Array.from({length: 13}, (_, i) => {
  const a = Math.PI * (i / 12 - 0.5);
  return [Math.cos(a), Math.sin(a)];
}));
/** A tube along points. */
function tube(way, radius, sectors = 8) {
  const positions = [], corners = [];
  for (let i = 0; i < way.length; ++i) {
    const along = unit(sub(way[Math.min(i + 1, way.length - 1)], way[Math.max(i - 1, 0)]));
    const side = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), up = cross(along, side);
    for (let s = 0; s < sectors; ++s) {
      const a = 2 * Math.PI * s / sectors;
      positions.push(...add(way[i], add(times(side, radius * Math.cos(a)), times(up, radius * Math.sin(a)))));
    }
  }
  for (let i = 0; i + 1 < way.length; ++i) {
    for (let s = 0; s < sectors; ++s) {
      const a = i * sectors + s, b = i * sectors + (s + 1) % sectors;
      corners.push(a, b, b + sectors, a, b + sectors, a + sectors);
    }
  }
  return cornersOf(new Float32Array(positions), corners);
}

/** A ball around what a shape has, in its own frame: [centre, radius]. */
function ballAround(numbers, stride) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < numbers.length; i += stride) {
    const r = stride > 3 ? numbers[i + 3] : 0;
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], numbers[i + k] - r);
      high[k] = Math.max(high[k], numbers[i + k] + r);
    }
  }
  if (!(low[0] <= high[0])) return [[0, 0, 0], 0];
  return [times(add(low, high), 0.5), norm(sub(high, low)) / 2];
}

// ----------------------------------------------------------------------------------------------------------- drawing

const SHADE = `
  // Light from the sky, from the ground, and from beside the viewer.
  uniform vec3 eye;
  vec3 shaded(vec3 base, vec3 at, vec3 n, float glow) {
    vec3 view = normalize(eye - at);
    vec3 lamp = normalize(view + 0.6 * normalize(cross(view, vec3(0.0, 0.0, 1.0)) + vec3(1e-4)) + vec3(0.0, 0.0, 0.7));
    float sky = 0.5 + 0.5 * n.z;
    float key = max(dot(n, lamp), 0.0);
    vec3 light = mix(vec3(0.17, 0.165, 0.16), vec3(0.42, 0.44, 0.47), sky) + 0.66 * key;
    float shine = 0.10 * pow(max(dot(n, normalize(lamp + view)), 0.0), 40.0);
    return mix(base * light + shine, base, glow);
  }
  vec3 onScreen(vec3 c) { return pow(clamp(c, 0.0, 1.0), vec3(1.0 / 2.2)); }`;
const HIGHLIGHT = `
  uniform vec4 color, highlight, spot, id;  // highlight.a: its share far from the spot; below 0: none
  vec3 baseAt(vec3 at) {
    if (highlight.a < 0.0) return color.rgb;
    float d = length(at - spot.xyz) / spot.w;
    return mix(color.rgb, highlight.rgb, max(highlight.a, exp(-d * d)));
  }`;
const PROGRAMS = {
  surface: [`
    in vec3 position, normal; in vec4 cell;
    uniform mat4 world, toScreen;
    out vec3 at, n;
    void main() {
      vec4 p = world * vec4(position * cell.w + cell.xyz, 1.0);
      at = p.xyz; n = mat3(world) * normal;
      gl_Position = toScreen * p;
    }`, `
    in vec3 at, n; out vec4 pixel;
    uniform float glow;` + SHADE + HIGHLIGHT + `
    void main() {
      if (id.a > 0.0) { pixel = id; return; }
      pixel = vec4(onScreen(shaded(baseAt(at), at, normalize(gl_FrontFacing ? n : -n), glow)), 1.0) * color.a;
    }`],
  points: [`
    in vec4 cell;
    uniform mat4 world, toScreen; uniform float pixels;  // of 1 m at a distance of 1 m
    out vec3 center;
    void main() {
      vec4 p = world * vec4(cell.xyz, 1.0);
      center = p.xyz;
      gl_Position = toScreen * p;
      gl_PointSize = clamp(2.0 * cell.w * pixels / gl_Position.w, 1.5, 256.0);
    }`, `
    in vec3 center; out vec4 pixel;
    uniform float glow; uniform vec3 right, up;` + SHADE + HIGHLIGHT + `
    void main() {
      vec2 p = 2.0 * gl_PointCoord - 1.0;
      float square = dot(p, p);
      if (square > 1.0) discard;
      if (id.a > 0.0) { pixel = id; return; }
      vec3 n = right * p.x - up * p.y + normalize(eye - center) * sqrt(1.0 - square);
      pixel = vec4(onScreen(shaded(baseAt(center), center, normalize(n), glow)), 1.0) * color.a;
    }`],
  ground: [`
    in vec3 position;
    uniform mat4 world, toScreen;
    out vec3 at;
    void main() { vec4 p = world * vec4(position, 1.0); at = p.xyz; gl_Position = toScreen * p; }`, `
    in vec3 at; out vec4 pixel;
    uniform vec4 color; uniform float cell, reach;
    float lines(vec2 p) {
      vec2 d = abs(fract(p - 0.5) - 0.5) / fwidth(p);
      return 1.0 - clamp(min(d.x, d.y), 0.0, 1.0);
    }
    void main() {
      float far = clamp(1.0 - length(at.xy) / reach, 0.0, 1.0);
      float line = max(0.45 * lines(at.xy / cell), lines(at.xy / (5.0 * cell)));
      float a = color.a * far * far * line;
      pixel = vec4(color.rgb * a, a);
    }`],
};

/** Bodies on a canvas, by WebGL 2. */
class Screen {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = this.gl = canvas.getContext('webgl2', {antialias: true, alpha: true, stencil: true});
    if (!gl) throw new Error('WebGL 2 is missing');
    this.programs = {};
    for (const [name, [vertex, fragment]] of Object.entries(PROGRAMS)) this.programs[name] = this.program(vertex, fragment);
    this.cube = cube();
    this.shapes = motion.shapes.map((shape) => this.shapeOf(shape));
    this.ball = this.surface(ball());
    this.rod = this.surface(turned([[1, 0], [1, 1]]));
    this.tip = this.surface(turned([[0, 0], [1, 0], [0, 1]]));
    this.square = this.surface(cornersOf(new Float32Array([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0]), [0, 1, 2, 0, 2, 3]));
  }
  program(vertex, fragment) {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, code] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, `#version 300 es\nprecision highp float;${code}`);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    ['position', 'normal', 'cell'].forEach((name, i) => gl.bindAttribLocation(program, i, name));
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const uniforms = {};
    for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); ++i) {
      const {name} = gl.getActiveUniform(program, i);
      uniforms[name] = gl.getUniformLocation(program, name);
    }
    return {program, uniforms};
  }
  attribute(index, numbers, size, divisor = 0) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(index);
    gl.vertexAttribPointer(index, size, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(index, divisor);
  }
  surface({points, normals}, cells = null) {
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(0, points, 3);
    this.attribute(1, normals, 3);
    if (cells) this.attribute(2, cells, 4, 1);
    gl.bindVertexArray(null);
    return {program: 'surface', array, count: points.length / 3, copies: cells ? cells.length / 4 : 1};
  }
  shapeOf(shape) {
    if (shape.kind === 'triangles') {
      const positions = decoded(shape.positions, Float32Array);
      return {...this.surface(cornersOf(positions, decoded(shape.corners, Uint32Array))), around: ballAround(positions, 3)};
    }
    const balls = decoded(shape.balls, Float32Array), around = ballAround(balls, 4);
    if (shape.kind === 'cells') return {...this.surface(this.cube, balls), around};
    const gl = this.gl, array = gl.createVertexArray();
    gl.bindVertexArray(array);
    this.attribute(2, balls, 4);
    gl.bindVertexArray(null);
    return {program: 'points', array, count: balls.length / 4, around};
  }
  resize() {
    const scale = Math.min(window.devicePixelRatio || 1, 2), {canvas} = this;
    const width = Math.max(1, Math.round(canvas.clientWidth * scale)), height = Math.max(1, Math.round(canvas.clientHeight * scale));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
  }
  /** Begins a picture from a camera. */
  begin(camera, width, height) {
    const gl = this.gl;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0, 0, 0, 0);
    gl.clearDepth(1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    this.view = camera.look(width / height);
    this.pixels = height / 2 / Math.tan(camera.field / 2);
  }
  /** @param look  color, alpha, glow, highlight [r, g, b, floor], spot [x, y, z, radius], id [r, g, b, 1]; each optional. */
  draw(shape, world, look) {
    const gl = this.gl, {program, uniforms} = this.programs[shape.program];
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.world, false, world);
    gl.uniformMatrix4fv(uniforms.toScreen, false, this.view.toScreen);
    gl.uniform3fv(uniforms.eye, this.view.eye);
    gl.uniform4f(uniforms.color, ...(look.color || [0, 0, 0]), look.alpha ?? 1);
    gl.uniform4fv(uniforms.highlight, look.highlight || [0, 0, 0, -1]);
    gl.uniform4fv(uniforms.spot, look.spot || [0, 0, 0, 1]);
    gl.uniform4fv(uniforms.id, look.id || [0, 0, 0, 0]);
    gl.uniform1f(uniforms.glow, look.glow || 0);
    gl.bindVertexArray(shape.array);
    if (shape.program === 'points') {
      gl.uniform1f(uniforms.pixels, this.pixels);
      gl.uniform3fv(uniforms.right, this.view.right);
      gl.uniform3fv(uniforms.up, this.view.up);
      gl.drawArrays(gl.POINTS, 0, shape.count);
    } else {
      gl.vertexAttrib4f(2, 0, 0, 0, 1);  // where it is no array: one cell that changes nothing
      gl.drawArraysInstanced(gl.TRIANGLES, 0, shape.count, shape.copies);
    }
  }
  drawGround(z, reach, cell, rgb, alpha) {
    const gl = this.gl, {program, uniforms} = this.programs.ground;
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.world, false, [reach, 0, 0, 0, 0, reach, 0, 0, 0, 0, 1, 0, 0, 0, z, 1]);
    gl.uniformMatrix4fv(uniforms.toScreen, false, this.view.toScreen);
    gl.uniform4f(uniforms.color, ...rgb, alpha);
    gl.uniform1f(uniforms.cell, cell);
    gl.uniform1f(uniforms.reach, reach);
    gl.bindVertexArray(this.square.array);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    gl.drawArrays(gl.TRIANGLES, 0, this.square.count);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  }
  /** Draws what `draw` draws translucently: each pixel once, that which is in front. */
  translucent(draw) {
    const gl = this.gl;
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 4);  // what is drawn already at the same place stays
    gl.colorMask(false, false, false, false);
    draw();
    gl.colorMask(true, true, true, true);
    gl.enable(gl.BLEND);
    draw();
    gl.disable(gl.BLEND);
    gl.disable(gl.POLYGON_OFFSET_FILL);
  }
  /** Runs `draw` into a picture that nobody sees, of numbers in place of colours, and returns its pixels. */
  numbers(width, height, draw, part = [0, 0, width, height]) {
    const gl = this.gl;
    if (!this.hidden || this.hidden.width !== width || this.hidden.height !== height) {
      const frame = gl.createFramebuffer(), image = gl.createRenderbuffer(), depth = gl.createRenderbuffer();
      gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
      for (const [buffer, format, place] of [[image, gl.RGBA8, gl.COLOR_ATTACHMENT0], [depth, gl.DEPTH_COMPONENT24, gl.DEPTH_ATTACHMENT]]) {
        gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
        gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
        gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, buffer);
      }
      if (this.hidden) {
        gl.deleteFramebuffer(this.hidden.frame);
        gl.deleteRenderbuffer(this.hidden.image);
        gl.deleteRenderbuffer(this.hidden.depth);
      }
      this.hidden = {frame, image, depth, width, height};
    }
    gl.bindFramebuffer(gl.FRAMEBUFFER, this.hidden.frame);
    gl.enable(gl.SCISSOR_TEST);
    gl.scissor(...part);
    draw();
    const pixels = new Uint8Array(4 * part[2] * part[3]);
    gl.readPixels(...part, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    gl.disable(gl.SCISSOR_TEST);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    return pixels;
  }
}
const idOf = (number) => [(number & 255) / 255, ((number >> 8) & 255) / 255, ((number >> 16) & 255) / 255, 1];
const numberAt = (pixels, i) => (pixels[i + 3] ? pixels[i] | pixels[i + 1] << 8 | pixels[i + 2] << 16 : 0);

/** Looks at a target from an azimuth and an elevation, in radians, and a distance. */
class Camera {
  constructor() { Object.assign(this, {target: [0, 0, 0], azimuth: -1, elevation: 0.35, distance: 3, field: 0.5, size: 1}); }
  direction() {
    const c = Math.cos(this.elevation);
    return [c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation)];
  }
  look(aspect) {
    const back = this.direction();
    const right = [-Math.sin(this.azimuth), Math.cos(this.azimuth), 0], up = cross(back, right);
    const eye = add(this.target, times(back, this.distance));
    const near = Math.max(0.01 * this.distance, 1e-4 * this.size), far = this.distance + 60 * this.size;
    const f = 1 / Math.tan(this.field / 2);
    const view = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const lens = [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
    return {eye, right, up, toScreen: product(lens, view)};
  }
  turn(right, up) {
    this.azimuth += right;
    this.elevation = clamp(this.elevation + up, -1.55, 1.55);
  }
  /** @param right, up  in heights of the picture. */
  pan(right, up) {
    const {right: x, up: y} = this.look(1), height = 2 * this.distance * Math.tan(this.field / 2);
    this.target = add(this.target, add(times(x, right * height), times(y, up * height)));
  }
  zoom(factor) { this.distance = clamp(this.distance * factor, 0.02 * this.size, 40 * this.size); }
}

// ------------------------------------------------------------------------------------------------------------- state

const camera = new Camera();
let screen = null;
let now = BEGIN, playing = false, viewIsOwn = false, last = 0, due = false, under = null;
const seconds = () => Number($('speed').value);
const isOn = (id) => $(id).checked;

/** What a robot's way takes: a ball, [centre, radius], that holds it and the contacts. */
let stageBall = [[0, 0, 0], 1], stageParts = [], groundAt = 0, wayShape = null, wayOf = -1;

function measureStage() {
  const low = [Infinity, Infinity, Infinity], high = low.map((x) => -x);
  const include = (p, r = 0) => {
    stageParts.push([p, r]);
    for (let k = 0; k < 3; ++k) {
      low[k] = Math.min(low[k], p[k] - r);
      high[k] = Math.max(high[k], p[k] + r);
    }
  };
  for (let i = 0; i <= 16; ++i) {
    const frames = framesAt(BEGIN + (END - BEGIN) * i / 16);
    for (const body of bodies) {
      const [center, radius] = screen.shapes[body.shape].around;
      if (body.moves && radius < 1e6) include(moved(worldOf(body, frames), center), 0.8 * radius);
    }
  }
  for (const c of contacts) include(here(c.point));
  if (low[0] > high[0]) for (const body of bodies) include(moved(worldOf(body, []), [0, 0, 0]), 1);
  stageBall = [times(add(low, high), 0.5), Math.max(norm(sub(high, low)) / 2, 1e-6)];
  groundAt = low[2] - 0.01 * stageBall[1];
  camera.size = stageBall[1];
}

/** Draws all bodies as numbers, 1 for the first; the contact's place as the number after them. */
function drawNumbers(frames, contactBall) {
  bodies.forEach((body, i) => {
    if (body.visible) screen.draw(screen.shapes[body.shape], worldOf(body, frames), {id: idOf(i + 1)});
  });
  const c = contact();
  if (c && contactBall > 0) {
    screen.draw(screen.ball, scaledAt(here(c.point), contactBall), {id: idOf(bodies.length + 1)});
  }
}

/** Puts the camera as near as it has all of the stage in view. */
function fitView() {
  const {clientWidth, clientHeight} = screen.canvas, tangent = Math.tan(camera.field / 2) / 1.06;
  const {right, up} = camera.look(1), back = camera.direction();
  camera.distance = 0;
  for (const [p, r] of stageParts) {
    const d = sub(p, camera.target);
    camera.distance = Math.max(camera.distance, dot(d, back) + (Math.abs(dot(d, up)) + r) / tangent,
      dot(d, back) + (Math.abs(dot(d, right)) + r) / tangent * clientHeight / Math.max(clientWidth, 1));
  }
  camera.zoom(1);
}
/** Puts the camera where most of the contact and of what touches is seen. */
function chooseView() {
  camera.target = stageBall[0];
  camera.distance = 1.08 * stageBall[1] / Math.sin(camera.field / 2);
  const c = contact(), width = 96, height = 64;
  if (!bodies.length) return;
  const frames = framesAt(c ? momentOf(c) : BEGIN), mark = 0.05 * stageBall[1];
  let best = null;
  for (const elevation of [0.25, 0.55]) {
    for (let i = 0; i < 12; ++i) {
      camera.azimuth = -1 + 2 * Math.PI * i / 12;
      camera.elevation = elevation;
      const pixels = screen.numbers(width, height, () => {
        screen.begin(camera, width, height);
        drawNumbers(frames, mark);
      });
      let robot = 0, touching = 0, contactSeen = 0;
      for (let k = 0; k < pixels.length; k += 4) {
        const n = numberAt(pixels, k);
        if (n === bodies.length + 1) ++contactSeen;
        else if (n > 0 && bodies[n - 1].moves) ++robot;
        if (n > 0 && n <= bodies.length && sideOf(bodies[n - 1])) ++touching;
      }
      let score = robot / 800 - 0.4 * elevation + 0.02 * Math.cos(camera.azimuth + 1);
      if (c) {
        const aside = 1 - Math.abs(dot(c.normal, camera.direction()));  // a normal is seen best from the side
        score += 1.5 * Math.min(1, contactSeen / 8) + 0.5 * aside + Math.min(1, touching / 600);
      }
      if (!best || score > best.score) best = {score, azimuth: camera.azimuth, elevation};
    }
  }
  camera.azimuth = best.azimuth;
  camera.elevation = best.elevation;
  if (c) camera.target = add(times(stageBall[0], 0.65), times(here(c.point), 0.35));
  fitView();
}

/** The way of the point that touches, or of the body that goes farthest. */
function makeWay() {
  if (wayOf === chosen) return;
  wayOf = chosen;
  wayShape = null;
  const c = contact(), count = 160, walks = [];
  for (const body of bodies) {
    if (!body.moves || body.kind === 'moving obstacle' || (c && !sideOf(body))) continue;
    const start = worldOf(body, framesAt(c ? momentOf(c) : BEGIN));
    let local = screen.shapes[body.shape].around[0];
    if (c) {  // the contact in the body's frame: its matrix turns and moves only
      const d = sub(here(c.point), start.slice(12, 15));
      local = [0, 1, 2].map((k) => dot(d, start.slice(4 * k, 4 * k + 3)));
    }
    walks.push({body, local, way: [], length: 0});
  }
  for (let i = 0; i <= count; ++i) {
    const frames = framesAt(BEGIN + (END - BEGIN) * i / count);
    for (const walk of walks) {
      const p = moved(worldOf(walk.body, frames), walk.local), before = walk.way[walk.way.length - 1];
      const step = before ? norm(sub(p, before)) : 0;
      if (before && step < 1e-4 * stageBall[1]) continue;
      walk.length += step;
      walk.way.push(p);
    }
  }
  const best = walks.reduce((a, b) => (!a || b.length > a.length ? b : a), null);
  if (best && best.way.length > 1) wayShape = screen.surface(tube(best.way, 0.003 * stageBall[1]));
}

// ----------------------------------------------------------------------------------------------------------- picture

const isDark = () => root.dataset.theme === 'dark';

function drawBodies(frames, take, look) {
  for (const body of bodies) {
    if (body.visible && take(body)) screen.draw(screen.shapes[body.shape], worldOf(body, frames), look(body));
  }
}
function lookOf(body) {
  const c = contact(), side = sideOf(body), [, size] = screen.shapes[body.shape].around;
  const look = {color: body.color, glow: body === under ? 0.35 : 0};
  if (side) {
    // What is small is coloured as a whole, what is large about the contact.
    const floor = side === 1 || body.moves ? 0.8 : clamp(1.1 - size / (0.6 * stageBall[1]), 0, 0.9);
    look.highlight = [...color(side === 1 ? TOUCHING : TOUCHED), floor];
    look.spot = [...here(c.point), 0.3 * stageBall[1]];
  }
  return look;
}
/** The contact's point and normal, and the points that are nearest just before it: through what hides them, too. */
function drawMarks() {
  const c = contact();
  if (!c) return;
  const p = here(c.point), height = 2 * norm(sub(screen.view.eye, p)) * Math.tan(camera.field / 2);
  const normal = unit(c.normal), side = unit(cross(normal, Math.abs(normal[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
  const other = cross(normal, side);
  const along = (from, length, radius) => [...times(side, radius), 0, ...times(other, radius), 0, ...times(normal, length), 0, ...from, 1];
  const draw = (alpha) => {
    const look = {color: color(MARK), glow: 0.4, alpha};
    screen.draw(screen.ball, scaledAt(p, 0.0085 * height), look);
    screen.draw(screen.rod, along(p, 0.1 * height, 0.003 * height), look);
    screen.draw(screen.tip, along(add(p, times(normal, 0.1 * height)), 0.035 * height, 0.01 * height), look);
    for (const near of [c.nearest1, c.nearest2]) {
      screen.draw(screen.ball, scaledAt(here(near), 0.005 * height), {color: color(0x1b232c), glow: 0.2, alpha});
    }
  };
  const gl = screen.gl;
  gl.depthFunc(gl.GREATER);
  gl.depthMask(false);
  gl.enable(gl.BLEND);
  draw(0.35);
  gl.disable(gl.BLEND);
  gl.depthMask(true);
  gl.depthFunc(gl.LEQUAL);
  draw(1);
}
function drawShadows(frames) {
  const gl = screen.gl, z = groundAt, lean = [0.25, -0.15];
  // Along the light onto the plane of the ground.
  const flat = [1, 0, 0, 0, 0, 1, 0, 0, -lean[0], -lean[1], 0, 0, lean[0] * z, lean[1] * z, z, 1];
  gl.enable(gl.STENCIL_TEST);
  gl.stencilFunc(gl.EQUAL, 0, 255);
  gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
  gl.enable(gl.BLEND);
  gl.depthMask(false);
  for (const body of bodies) {
    const shape = screen.shapes[body.shape];
    if (!body.visible || shape.program === 'points') continue;
    const world = worldOf(body, frames), [center, size] = shape.around;
    if (norm(sub(moved(world, center), stageBall[0])) > size + 3 * stageBall[1]) continue;
    if (moved(world, center)[2] + size < z) continue;
    screen.draw(shape, product(flat, world), {color: [0, 0, 0], glow: 1, alpha: isDark() ? 0.35 : 0.14});
  }
  gl.depthMask(true);
  gl.disable(gl.BLEND);
  gl.disable(gl.STENCIL_TEST);
}
function draw() {
  due = false;
  if (!screen) return;
  screen.resize();
  makeWay();
  const {canvas} = screen, frames = framesAt(now);
  screen.begin(camera, canvas.width, canvas.height);
  drawBodies(frames, () => true, lookOf);
  if (isOn('show-trace') && wayShape) screen.draw(wayShape, IDENTITY, {color: color(contact() ? TOUCHING : BEFORE), glow: 0.6});
  if (isOn('show-ground')) {
    const cell = 10 ** Math.round(Math.log10(stageBall[1] / 4));
    screen.drawGround(groundAt, 5 * stageBall[1], cell, isDark() ? [0.75, 0.8, 0.85] : [0.3, 0.35, 0.4], isDark() ? 0.3 : 0.35);
    if (screen.view.eye[2] > groundAt) drawShadows(frames);
  }
  drawMarks();
  drawWitness();
  if (isOn('show-ends')) {
    for (const [t, hex] of [[BEGIN, BEFORE], [END, AFTER]]) {
      const ends = framesAt(t);
      screen.translucent(() => drawBodies(ends, (body) => body.moves, () => ({color: color(hex), glow: 0.3, alpha: 0.22})));
    }
  }
}
function drawWitness() {
  if (!isOn('show-witness')) return;
  screen.translucent(() => {
    for (const {body, pose} of witness()) {
      const {shape, visible} = bodies[body];
      if (visible) screen.draw(screen.shapes[shape], matrixOf(pose), {color: color(WITNESS), glow: 0.3, alpha: 0.45});
    }
  });
}
function redraw() {
  if (!due) requestAnimationFrame(draw);
  due = true;
}

// -------------------------------------------------------------------------------------------------------------- time

function setTime(t) {
  now = clamp(t, BEGIN, END);
  $('time').value = (now - BEGIN) / (END - BEGIN);
  $('time').setAttribute('aria-valuetext', `t = ${shown(now, 6)}`);
  $('clock').textContent = `t = ${shown(now, 5)}`;
  $('joints-time').textContent = `t = ${shown(now, 6)}`;
  for (let v = 0; v < DOF; ++v) jointTexts(v, valueAt(now, v)).forEach((text, k) => { jointCells[2 * v + k].textContent = text; });
  moveCursor();
  redraw();
}
function play(on) {
  playing = on;
  $('play').textContent = on ? '❚❚' : '▶';
  $('play').setAttribute('aria-label', on ? 'Pause' : 'Play');
  if (!on) return;
  if (now >= END) setTime(BEGIN);
  last = performance.now();
  requestAnimationFrame(advance);
}
function advance(at) {
  if (!playing) return;
  const step = (END - BEGIN) * Math.max(0, at - last) / 1000 / seconds();
  last = at;
  setTime(now + step);
  if (now >= END) play(false); else requestAnimationFrame(advance);
}

// -------------------------------------------------------------------------------------------------------------- plot

const SVG = 'http://www.w3.org/2000/svg';
const LEFT = 44, RIGHT = 12, TOP = 8, BOTTOM = 20;
const svg = $('curve');
let plotWidth = 600, plotHeight = 150, cursor = null;
const xOf = (t) => LEFT + (plotWidth - LEFT - RIGHT) * (t - BEGIN) / (END - BEGIN);
function part(name, attributes, text) {
  const node = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  if (text !== undefined) node.textContent = text;
  svg.append(node);
  return node;
}
/** A round step that divides a length into some five. */
function roundStep(length) {
  const raw = length / 5, power = 10 ** Math.floor(Math.log10(raw));
  return power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
}
const series = () => [['obstacles', 'distance to obstacles'], ['links', 'between links']]
  .filter(([key]) => motion.distances[key]).map(([key, name]) => ({key, name, steps: motion.distances[key]}));

function drawPlot() {
  svg.replaceChildren();
  plotWidth = Math.max(svg.clientWidth, 200);
  plotHeight = motion.distances.missing ? 44 : svg.clientHeight || 150;
  svg.setAttribute('viewBox', `0 0 ${plotWidth} ${plotHeight}`);
  const css = getComputedStyle(root), hue = (name) => css.getPropertyValue(name).trim();
  const floor = plotHeight - BOTTOM;
  // What is proven of the motion: free, then the bracket, then nothing.
  const free = answer.status === 'free' ? END : answer.t_lower;
  if (free > BEGIN) {
    part('rect', {x: xOf(BEGIN), y: TOP, width: xOf(free) - xOf(BEGIN), height: floor - TOP, fill: hue('--free'), opacity: 0.12});
  }
  if (free < END) {
    part('rect', {x: xOf(free), y: TOP, width: xOf(END) - xOf(free), height: floor - TOP, fill: hue('--soft'), opacity: 0.1});
  }
  let top = 0;
  for (const {steps} of series()) {
    for (const s of steps) top = Math.max(top, s.upper === null ? (s.cut_off ? 0 : motion.distances.most) : s.upper);
  }
  top = (top || motion.distances.most || 1) * 1.06;
  const yOf = (d) => floor - (floor - TOP) * Math.min(d / top, 1);
  if (!motion.distances.missing) {
    const step = roundStep(top);
    for (let d = 0; d <= top; d += step) {
      part('line', {x1: LEFT, x2: plotWidth - RIGHT, y1: yOf(d), y2: yOf(d), stroke: hue('--line')});
      part('text', {x: LEFT - 6, y: yOf(d) + 4, 'text-anchor': 'end'}, `${shown(d, 3)}`);
    }
    part('text', {x: 2, y: TOP + 4}, 'm');
  }
  const step = roundStep(END - BEGIN);
  for (let k = Math.ceil(BEGIN / step - 1e-9); k * step <= END + 1e-9 * step; ++k) {
    part('line', {x1: xOf(k * step), x2: xOf(k * step), y1: floor, y2: floor + 4, stroke: hue('--soft')});
    part('text', {x: xOf(k * step), y: plotHeight - 4, 'text-anchor': 'middle'}, shown(k * step, 6));
  }
  for (const {key, steps} of series()) {
    const at = motion.distances.times;
    let low = '', band = '';
    steps.forEach((s, i) => {
      if (s.cut_off) return;
      const x = xOf(at[i]), end = xOf(at[i + 1]);
      const upper = s.upper === null ? top : s.upper;
      band += `M${x} ${yOf(s.lower)}H${end}V${yOf(upper)}H${x}Z`;
      low += `M${x} ${yOf(s.lower)}H${end}`;
      const next = steps[i + 1];
      if (next && !next.cut_off) low += `V${yOf(next.lower)}`;
    });
    part('path', {d: band, fill: hue(`--${key}`), opacity: 0.3});
    part('path', {d: low, fill: 'none', stroke: hue(`--${key}`), 'stroke-width': 1.6});
  }
  contacts.forEach((c, i) => {
    const width = Math.max(xOf(c.certain ? c.t_upper : c.t_lower) - xOf(c.t_lower), i === chosen ? 2 : 1);
    const middle = (xOf(c.t_lower) + xOf(c.certain ? c.t_upper : c.t_lower)) / 2;
    const mark = part('rect', {x: middle - width / 2, y: TOP - 4, width, height: floor - TOP + 4, fill: hue('--contact')});
    mark.append(document.createElementNS(SVG, 'title'));
    mark.firstChild.textContent = `${c.body1.name} and ${c.body2.name}: t in [${c.t_lower}, ${c.t_upper}]`;
  });
  if (answer.status === 'undecided') {
    part('rect', {x: xOf(free) - 1, y: TOP - 4, width: 2, height: floor - TOP + 4, fill: hue('--undecided')});
  }
  cursor = part('line', {y1: 0, y2: floor + 4, stroke: hue('--ink'), 'stroke-width': 1.2});
  moveCursor();
}
function moveCursor() {
  if (cursor) for (const x of ['x1', 'x2']) cursor.setAttribute(x, xOf(now));
  $('reading').textContent = readingAt(now);
}
/** What is known of the distances at time t. */
function readingAt(t) {
  if (motion.distances.missing || !motion.distances.times.length) return '';
  const at = motion.distances.times;
  let i = at.findIndex((_, k) => k + 1 < at.length && t < at[k + 1]);
  if (i < 0) i = at.length - 2;
  const known = series().map(({key, steps}) => {
    const s = steps[i];
    if (s.cut_off) return `${key}: not found within the work allowed`;
    if (s.upper === null) return `${key}: more than ${lowerText(s.lower)} m`;
    if (s.upper === 0) return `${key}: ${s.pair[0]} and ${s.pair[1]} touch`;
    return `${key}: ≥ ${lowerText(s.lower)} m; ${s.pair[0]} – ${s.pair[1]} ≤ ${upperText(s.upper)} m`;
  });
  return `t in ${shown(at[i], 4)} … ${shown(at[i + 1], 4)} · ${known.join(' · ')}`;
}
function writeLegend() {
  const item = (background, text) => {
    const box = element('i');
    box.style.background = background;
    $('legend').append(element('span', {}, box, text));
  };
  const pale = (name) => `color-mix(in srgb, var(${name}) 25%, transparent)`;
  if (motion.distances.missing) $('legend').append(element('span', {}, `Distances are not measured: ${motion.distances.missing}`));
  for (const {key, name} of series()) item(`var(--${key})`, name);
  if (answer.status === 'free' || answer.t_lower > BEGIN) item(pale('--free'), 'proven free');
  if (contacts.length) item('var(--contact)', contacts.length > 1 ? 'contacts' : 'contact');
  if (motion.witnesses.some(Boolean)) item(`#${WITNESS.toString(16)}`, 'your robot may touch here');
  if (answer.status !== 'free') item(pale('--soft'), contacts.length ? 'after it: no verdict' : 'no verdict');
}

// ------------------------------------------------------------------------------------------------------------- panel

/** An element with text and attributes. Names of bodies and joints go in as text, never as HTML. */
function element(name, attributes = {}, ...content) {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === 'onclick' || key === 'onchange') node[key] = value; else node.setAttribute(key, value);
  }
  node.append(...content);
  return node;
}
/** @param rows  name, value or values, title. */
function table(rows, numbers = false) {
  return element('table', {}, element('tbody', {}, ...rows.map(([name, value, title]) => {
    const cells = [].concat(value).map((text) => element('td', {...(numbers && {class: 'number'}), ...(title && {title})}, String(text)));
    return element('tr', {}, element('th', {scope: 'row'}, name), ...cells);
  })));
}
const words = (key) => key.replace(/_us$/, '').replaceAll('_', ' ');
/** The fewest digits that tell two times apart, in the way that keeps what is between them. */
function bracketText(lower, upper) {
  let digits = 5;
  while (digits < 15 && lower !== upper && shown(lower, digits) === shown(upper, digits)) ++digits;
  return `${shown(lower, digits + 1)} to ${shown(upper, digits + 1)}`;
}
/** To five digits of its largest number: what is smaller than these is 0. */
function vectorText(v) {
  const least = 1e-5 * Math.max(...v.map(Math.abs));
  return `(${v.map((x) => shown(Math.abs(x) < least ? 0 : x, 5)).join(', ')})`;
}
const bodyText = (body) => (body.kind === 'attached object' ? `${body.name} (on ${body.link})` : body.name)
  + (body.triangle === null ? '' : `, triangle ${body.triangle}`);

function writeContacts() {
  $('contacts').replaceChildren(...contacts.map((c, i) => {
    const title = element('button', {type: 'button', class: 'pair', 'aria-pressed': String(i === chosen), title: 'Show this contact',
      onclick: () => choose(i)}, element('span', {class: 'one'}, c.body1.name), ' – ', element('span', {class: 'two'}, c.body2.name));
    const rows = [
      ['time', bracketText(c.t_lower, c.t_upper), `[${c.t_lower}, ${c.t_upper}]`],
      ['', c.certain ? 'contact proven' : 'not proven: nearer than can be decided'],
    ];
    if (i === chosen) {
      rows.push(['body 1', bodyText(c.body1)], ['body 2', bodyText(c.body2)], ['features', c.feature],
        ['point', `${vectorText(c.point)} m`, c.point.join(', ')], ['normal', vectorText(c.normal), c.normal.join(', ')],
        ['nearest 1', `${vectorText(c.nearest1)} m`, c.nearest1.join(', ')], ['nearest 2', `${vectorText(c.nearest2)} m`, c.nearest2.join(', ')],
        ['approach', `${shown(c.approach_speed, 4)} m per unit of t`]);
    }
    return element('div', {class: i === chosen ? 'card' : 'card other'}, title, table(rows));
  }));
}
function choose(i) {
  chosen = i;
  writeContacts();
  writeBodies();
  drawPlot();
  setTime(momentOf(contacts[i]));
}

/** A joint's value, and an angle's in degrees. */
function jointTexts(v, value) {
  const unit = motion.variables[v].unit;
  if (unit === 'rad') return [`${fixed(value, 4)} rad`, `${fixed(value * 180 / Math.PI, 1)}°`];
  return [unit === 'm' ? `${fixed(value, 4)} m` : fixed(value, 4), ''];
}
let jointCells = [];  // two a joint
function writeJoints() {
  $('joints').replaceChildren(table(motion.variables.map(({name}) => [name, ['', '']]), true));
  jointCells = [...$('joints').querySelectorAll('td')];
}
function writeBodies() {
  const groups = new Map();
  for (const body of bodies) groups.set(body.name, [...(groups.get(body.name) || []), body]);
  $('bodies').replaceChildren(...[...groups].map(([name, all]) => {
    const box = element('input', {type: 'checkbox', onchange: () => {
      for (const body of all) body.visible = box.checked;
      redraw();
    }});
    box.checked = all[0].visible;
    const color = element('span', {class: 'swatch'}), side = sideOf(all[0]);
    const hex = side === 1 ? TOUCHING : side === 2 ? TOUCHED : all[0].hex;
    color.style.background = `#${hex.toString(16).padStart(6, '0')}`;
    const label = element('label', {}, box, color, name, element('span', {class: 'kind'}, all[0].kind));
    label.onpointerenter = () => { under = all[0]; redraw(); };
    label.onpointerleave = () => { under = null; redraw(); };
    return label;
  }));
}
/** Of what a request says. */
const UNITS = {tolerance_time: 'of t', tolerance_distance: 'm', margin: 'm', budget: 'tests'};
const PIECES = motion.pieces;
function writeFacts() {
  const s = answer.statistics, r = answer.request;
  $('subtitle').textContent = `${answer.robot} · t from ${shown(BEGIN, 6)} to ${shown(END, 6)}`
    + (motion.distances.pairs === undefined ? '' : ` · ${motion.distances.pairs} ${motion.distances.pairs === 1 ? 'pair' : 'pairs'} of bodies checked`);
  const rows = [['status', answer.status], ['certain', answer.certain ? 'yes' : 'no'],
    ['t_lower', shown(answer.t_lower, 12), String(answer.t_lower)], ['t_upper', shown(answer.t_upper, 12), String(answer.t_upper)],
    ['allowed pairs not proven apart', answer.unproven_allowed_pairs]];
  for (const [a, b] of answer.unproven_neighbours ?? []) rows.push(['neighbours not proven apart', `${a}, ${b}`]);
  for (const [a, b] of answer.ignored_initial_contacts) rows.push(['ignored at the start', `${a}, ${b}`]);
  if (answer.clearance) rows.push(['clearance, at least', `${shown(answer.clearance.lower, 6)} m`]);
  if (answer.certificate) rows.push(['certificate', answer.certificate.missing || `${answer.certificate.proof_bytes} bytes`]);
  $('facts').replaceChildren(table(rows));
  $('request').replaceChildren(r ? table(Object.entries(r).map(([key, value]) => [words(key), typeof value === 'boolean' ? (value ? 'yes' : 'no') : key in UNITS ? `${value} ${UNITS[key]}` : value]), true)
    : element('p', {}, 'It is not known here what was asked for.'));
  const numbers = Object.entries(s).filter(([, value]) => typeof value === 'number');
  $('work').replaceChildren(table(numbers.map(([key, value]) => (key.endsWith('_us') ? [words(key), `${shown(value / 1000, 4)} ms`] : [key === 'pairs' && PIECES > 1 ? 'pairs, in all pieces' : words(key), value])), true));
  $('notes-of').hidden = answer.notes.length === 0;
  $('notes').replaceChildren(...answer.notes.map((note) => element('p', {}, note)));
}
function writeProven() {
  const say = (text) => $('proven').append(element('p', {}, text));
  say('Proven: the verdict; that nothing checked touches before t_lower; and, where it says so, that there is contact at or before t_upper.');
  if (!motion.distances.missing) {
    say('Proven up to rounding: the distances. Each step of the curve holds for its whole stretch of time: no checked pair comes nearer than its lower edge, and at one time in it a pair comes as near as its upper edge. Distances above '
      + `${shown(motion.distances.most, 3)} m are not looked for.`);
  }
  say(`Drawn only: the bodies. Their poses were computed at ${TIMES.length} times and are interpolated between them; round shapes are drawn as polyhedra. Point, normal, nearest points and speed of a contact are computed, not proven.`);
  motion.shapes.forEach((shape, i) => {
    if (shape.every < 2) return;
    const names = bodies.filter((body) => body.shape === i).map((body) => body.name);
    say(`Of ${shape.count} ${shape.kind} of ${names[0]} one in ${shape.every} is drawn; all were checked.`);
  });
  if (!contacts.length) return;
  if (motion.witnesses.some(Boolean)) say('Magenta is a place within the tolerances, of joints, base and objects, at which the chosen contact is proven: at its t_upper.');
  say('The bodies of the chosen contact are red and amber. The mark is its point with its normal, which points from the red to the amber body; the dark points are those that are nearest to each other at t_lower.');
}

// ------------------------------------------------------------------------------------------------------------- input

const KEYS = {
  ArrowLeft: (e) => (e.shiftKey ? camera.pan(-0.05, 0) : camera.turn(-0.08, 0)),
  ArrowRight: (e) => (e.shiftKey ? camera.pan(0.05, 0) : camera.turn(0.08, 0)),
  ArrowUp: (e) => (e.shiftKey ? camera.pan(0, 0.05) : camera.turn(0, 0.06)),
  ArrowDown: (e) => (e.shiftKey ? camera.pan(0, -0.05) : camera.turn(0, -0.06)),
  '+': () => camera.zoom(0.9),
  '-': () => camera.zoom(1 / 0.9),
  r: () => chooseView(),
};
function pick(x, y) {
  const {canvas} = screen, scale = canvas.width / canvas.clientWidth;
  const at = [Math.floor(x * scale), canvas.height - 1 - Math.floor(y * scale), 1, 1];
  const pixel = screen.numbers(canvas.width, canvas.height, () => {
    screen.begin(camera, canvas.width, canvas.height);
    drawNumbers(framesAt(now), 0);
  }, at);
  return bodies[numberAt(pixel, 0) - 1] || null;
}
function listenToCanvas(canvas) {
  const pointers = new Map();
  const relative = (e) => {
    const box = canvas.getBoundingClientRect();
    return [e.clientX - box.left, e.clientY - box.top];
  };
  canvas.addEventListener('pointerdown', (e) => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, relative(e));
    viewIsOwn = true;
    $('over').style.opacity = 0;
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (e) => pointers.delete(e.pointerId));
  canvas.addEventListener('pointermove', (e) => {
    const [x, y] = relative(e), height = canvas.clientHeight;
    if (!pointers.has(e.pointerId)) return showName(x, y);
    const [x0, y0] = pointers.get(e.pointerId), others = [...pointers].filter(([id]) => id !== e.pointerId);
    pointers.set(e.pointerId, [x, y]);
    if (others.length) {  // two fingers zoom and move
      const [, [ox, oy]] = others[0];
      camera.zoom(Math.hypot(x0 - ox, y0 - oy) / Math.max(Math.hypot(x - ox, y - oy), 1));
      camera.pan((x0 - x) / height / 2, (y - y0) / height / 2);
    } else if (e.shiftKey || e.buttons & 6) {
      camera.pan((x0 - x) / height, (y - y0) / height);
    } else {
      camera.turn(-(x - x0) * 0.008, (y - y0) * 0.008);
    }
    redraw();
  });
  canvas.addEventListener('pointerleave', () => { $('over').style.opacity = 0; if (under) { under = null; redraw(); } });
  canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  canvas.addEventListener('wheel', (e) => {
    e.preventDefault();
    viewIsOwn = true;
    camera.zoom(Math.exp(clamp(e.deltaY * (e.deltaMode ? 20 : 1), -200, 200) * 0.0015));
    redraw();
  }, {passive: false});
  canvas.addEventListener('dblclick', () => { chooseView(); redraw(); });
  canvas.addEventListener('keydown', (e) => {
    const action = KEYS[e.key === '=' ? '+' : e.key.length === 1 ? e.key.toLowerCase() : e.key];
    if (!action || e.ctrlKey || e.metaKey || e.altKey) return;
    e.preventDefault();
    viewIsOwn = true;
    action(e);
    redraw();
  });
}
let naming = false;
function showName(x, y) {
  if (naming || playing) return;
  naming = true;
  requestAnimationFrame(() => {
    naming = false;
    const body = pick(x, y), over = $('over');
    if (body !== under) { under = body; redraw(); }
    over.style.opacity = body ? 1 : 0;
    if (!body) return;
    over.textContent = body.kind === 'link' ? body.name : `${body.name} (${body.kind}${body.link ? ` on ${body.link}` : ''})`;
    over.style.left = `${x + 14}px`;
    over.style.top = `${y + 10}px`;
  });
}
function listen() {
  $('play').onclick = () => play(!playing);
  $('time').oninput = () => { play(false); setTime(BEGIN + (END - BEGIN) * Number($('time').value)); };
  $('reset').onclick = () => { chooseView(); redraw(); };
  $('witness-of').hidden = !motion.witnesses.some(Boolean);
  for (const id of ['show-ends', 'show-trace', 'show-witness', 'show-ground']) $(id).onchange = redraw;
  $('theme').onclick = () => setTheme(isDark() ? 'light' : 'dark');
  const goal = contacts.length ? momentOf(contacts[0]) : answer.status === 'free' ? null : answer.t_lower;
  $('go').hidden = goal === null;
  $('go').textContent = contacts.length ? 'To contact' : 'To t_lower';
  const go = () => { if (goal !== null) { play(false); setTime(contacts.length ? momentOf(contact()) : goal); } };
  $('go').onclick = go;
  document.addEventListener('keydown', (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey || /^(INPUT|SELECT|BUTTON|SUMMARY)$/.test(e.target.tagName)) return;
    if (e.key === ' ') { e.preventDefault(); play(!playing); }
    if (e.key.toLowerCase() === 'c') go();
    if (e.key === 'Home') setTime(BEGIN);
    if (e.key === 'End') setTime(END);
  });
  const scrub = (e) => {
    if (e.type === 'pointermove' && !(e.buttons & 1)) return;
    play(false);
    const x = (e.clientX - svg.getBoundingClientRect().left) * plotWidth / svg.clientWidth;
    setTime(BEGIN + (END - BEGIN) * (x - LEFT) / (plotWidth - LEFT - RIGHT));
  };
  svg.addEventListener('pointerdown', (e) => { svg.setPointerCapture(e.pointerId); scrub(e); });
  svg.addEventListener('pointermove', scrub);
  new ResizeObserver(() => {
    drawPlot();
    if (screen && !viewIsOwn) fitView();
    redraw();
  }).observe($('stage'));
  window.addEventListener('hashchange', () => { readAddress(); redraw(); });
}
function setTheme(theme) {
  root.dataset.theme = theme;
  drawPlot();
  redraw();
}
/** What the address says after its #. */
function readAddress() {
  const given = new URLSearchParams(location.hash.slice(1));
  if (/^(light|dark)$/.test(given.get('theme') || '')) setTheme(given.get('theme'));
  if (given.has('t') && Number.isFinite(Number(given.get('t')))) setTime(Number(given.get('t')));
  const view = (given.get('view') || '').split(',').map(Number);
  if (view.length === 2 && view.every(Number.isFinite)) {
    camera.azimuth = view[0] * Math.PI / 180;
    camera.elevation = clamp(view[1] * Math.PI / 180, -1.55, 1.55);
    if (screen) fitView();
  }
  if (given.has('play')) play(true);
}

// ------------------------------------------------------------------------------------------------------------- start

root.dataset.theme = window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
writeFacts();
writeContacts();
writeJoints();
writeBodies();
writeLegend();
writeProven();
if (motion.distances.missing) svg.style.height = '44px';
try {
  screen = new Screen($('canvas'));
  measureStage();
  chooseView();
  listenToCanvas($('canvas'));
} catch (error) {
  screen = null;
  $('problem').hidden = false;
  $('problem').textContent = `The motion cannot be drawn: ${error.message}. All else on this page is as it should be.`;
}
listen();
drawPlot();
setTime(contacts.length ? momentOf(contacts[0]) : BEGIN);
readAddress();
draw();
if (screen) {  // for tests: how many pixels of the picture show something
  const {canvas, gl} = screen, pixels = new Uint8Array(4 * canvas.width * canvas.height);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let drawn = 0;
  for (let i = 3; i < pixels.length; i += 4) drawn += pixels[i] > 0;
  root.dataset.drawnPixels = drawn;
  const box = $('show-witness');
  box.checked = false;
  draw();
  const without = new Uint8Array(pixels.length);
  gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, without);
  let ofWitness = 0;
  for (let i = 0; i < pixels.length; i += 4) ofWitness += [0, 1, 2, 3].some((k) => pixels[i + k] !== without[i + k]);
  root.dataset.witnessPixels = ofWitness;
  box.checked = true;
  draw();
}
root.dataset.ready = screen ? 'drawn' : 'not drawn';
})();
