// Draws the path: WebGL 2. While it moves, in few vertices; 150 ms later with all detail and smooth edges.
let draw = () => {};
const gl = canvas.getContext("webgl2", { antialias: false });
if (gl) {
  const compile = (kind, source) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source); gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const shaders = gl.createProgram();
  gl.attachShader(shaders, compile(gl.VERTEX_SHADER, `#version 300 es
    in vec3 at; in float speed; in float along;
    uniform vec4 turn; uniform vec2 scale, shift; uniform float size;
    out float v; out float s; out float z;
    void main() {
      float x = turn.x * at.x - turn.y * at.y, y = turn.y * at.x + turn.x * at.y;
      vec2 p = vec2(x, turn.w * y + turn.z * at.z);
      gl_Position = vec4(p * scale + shift, 0.0, 1.0);
      gl_PointSize = size; v = speed; s = along; z = at.z;
    }`));
  // Paint without alpha: colours by speed. Dash: dashes of rapid motion per length; 0 leaves rapid motion out.
  gl.attachShader(shaders, compile(gl.FRAGMENT_SHADER, `#version 300 es
    precision highp float;
    in float v; in float s; in float z; out vec4 colour;
    uniform vec4 paint; uniform float dash; uniform vec2 layer;
    vec3 ramp(float t) {
      vec3 c[5] = vec3[5](vec3(.17,.30,.77), vec3(.10,.60,.63), vec3(.30,.68,.24), vec3(.91,.69,.13), vec3(.83,.23,.16));
      float u = clamp(t, 0.0, 1.0) * 4.0; int i = min(int(u), 3);
      return mix(c[i], c[i + 1], u - float(i));
    }
    void main() {
      if (z < layer.x || z > layer.y) discard;
      bool rapid = v < -0.001 && v > -1.5;
      if (rapid && (dash == 0.0 || fract(s * dash) > 0.5)) discard;
      if (paint.a > 0.0) colour = paint;
      else if (rapid) colour = vec4(.25, .28, .36, 1.0);
      else colour = vec4(ramp(v), 1.0);
    }`));
  gl.linkProgram(shaders); gl.useProgram(shaders);
  const uniform = name => gl.getUniformLocation(shaders, name);
  const u = { turn: uniform("turn"), scale: uniform("scale"), shift: uniform("shift"), size: uniform("size"),
    paint: uniform("paint"), dash: uniform("dash"), layer: uniform("layer") };
  const upload = content => {
    const buffer = gl.createBuffer(), array = gl.createVertexArray();
    gl.bindVertexArray(array); gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, content.data, gl.STATIC_DRAW);
    [["at", 3, 0], ["speed", 1, 12], ["along", 1, 16]].forEach(([name, count, offset]) => {
      const index = gl.getAttribLocation(shaders, name);
      gl.enableVertexAttribArray(index); gl.vertexAttribPointer(index, count, gl.FLOAT, false, 20, offset);
    });
    return { array, buffer, count: content.count };
  };
  const uploaded = new Map();
  const bind = line => {
    if (!uploaded.has(line)) uploaded.set(line, upload(line));
    gl.bindVertexArray(uploaded.get(line).array);
  };
  const cornerData = new Float32Array((columns.bx || []).length * 5);
  for (let b = 0; b * 5 < cornerData.length; b++) {
    ["bx", "by", "bz"].forEach((name, d) => { cornerData[b * 5 + d] = columns[name] ? (columns[name][b] - middle[d]) / size : 0; });
    cornerData[b * 5 + 3] = tolerance[b] ? 1 : 0;
  }
  const corners = upload({ data: cornerData, count: cornerData.length / 5 });
  const point = upload({ data: new Float32Array(5), count: 1 });
  const paint = (r, g, b, a) => gl.uniform4f(u.paint, r, g, b, a);

  // Vertices nearer than this many pixels are left out. A line has no more than its part of the budget: vertices of
  // one frame that this computer draws quickly. `missing`: the budget left out more.
  const NEAR = { fine: 0.6, moving: 2 };
  const budget = { fine: 60000, moving: 15000 };
  let missing = false;
  const level = (layer, fine, passes) => {
    let k = Math.ceil(Math.log2(view.scale / (fine ? NEAR.fine : NEAR.moving)));
    k = Math.max(4, Math.min(19, k));
    const most = (fine ? budget.fine : budget.moving) / passes;
    while (k > 4 && layer(k).count > most) { k--; missing = true; }
    return layer(k);
  };
  const strip = (content, isCut) => {
    const from = isCut ? Math.max(0, last(content.index, cut.from)) : 0;
    const to = isCut ? last(content.index, cut.to) + 1 : content.count;
    bind(content);
    gl.drawArrays(gl.LINE_STRIP, from, Math.max(0, to - from));
  };
  const paths = (fine, w, h, ratio) => {
    // The browser's lines are one pixel wide: wider ones are drawn several times, side by side.
    const each = (pixels, layer, isCut) => {
      const content = level(layer, fine, pixels * pixels);
      for (let k = 0; k < pixels * pixels; k++) {
        const [x, y] = [k % pixels, Math.floor(k / pixels)].map(v => v - (pixels >> 1));
        gl.uniform2f(u.shift, (view.x + x / ratio) * 2 / w, (y / ratio - view.y) * 2 / h);
        strip(content, isCut);
      }
    };
    const isMoved = $("moved").checked, dash = view.scale / 10, narrow = fine ? 2 : 1;
    if ($("programmed").checked) {
      paint(.72, .75, .8, 1);
      // Rapid motion that is driven is drawn as driven: two rows of dashes would fill each other's gaps.
      gl.uniform1f(u.dash, isMoved ? 0 : dash);
      each(narrow, layers.programmed, false);
    }
    gl.uniform1f(u.dash, dash);
    // A wider line below the driven one: both are seen where they are the same.
    if (layers.filtered && $("filtered").checked) {
      paint(.87, .45, .9, 1); each(2 * narrow, layers.filtered, true);
    }
    if (isMoved) { paint(0, 0, 0, 0); each(narrow, layers.moved, true); }
  };
  const points = (w, h, ratio) => {
    gl.uniform2f(u.shift, view.x * 2 / w, -view.y * 2 / h);
    gl.uniform1f(u.size, 5 * ratio); paint(0, 0, 0, 0);
    if ($("corners").checked) { gl.bindVertexArray(corners.array); gl.drawArrays(gl.POINTS, 0, corners.count); }
    gl.bindVertexArray(point.array); gl.bindBuffer(gl.ARRAY_BUFFER, point.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, new Float32Array([...place(cursor), 0, 0]));
    gl.uniform2f(u.layer, -9, 9); gl.uniform1f(u.size, 11 * ratio); paint(.1, .1, .1, 1);
    gl.drawArrays(gl.POINTS, 0, 1);
    gl.uniform1f(u.size, 7 * ratio); paint(1, .45, .1, 1); gl.drawArrays(gl.POINTS, 0, 1);
  };
  const frame = fine => {
    const ratio = fine ? 2 : 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (!w || !h) return;
    if (view.fit) fit();
    if (canvas.width !== w * ratio || canvas.height !== h * ratio) { canvas.width = w * ratio; canvas.height = h * ratio; }
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1); gl.clear(gl.COLOR_BUFFER_BIT);
    gl.uniform4f(u.turn, Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt));
    gl.uniform2f(u.scale, view.scale * 2 / w, view.scale * 2 / h);
    gl.uniform2f(u.layer, cut.low, cut.high);
    paths(fine, w, h, ratio);
    points(w, h, ratio);
    canvas.dataset.fine = +fine;
  };
  let asked = false, rest = 0;
  const refine = () => {
    if (asked) return;
    missing = false;
    frame(true);
    const begun = performance.now(), fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
    const done = () => {
      if (gl.getSyncParameter(fence, gl.SYNC_STATUS) !== gl.SIGNALED) return setTimeout(done, 4);
      gl.deleteSync(fence);
      const took = performance.now() - begun;
      if (took > 400) budget.fine = Math.max(30000, budget.fine / 2);
      else if (took < 80 && missing) {
        budget.fine *= 4; budget.moving = Math.min(100000, budget.fine / 8);
        if (!rest) refine();
      }
    };
    setTimeout(done, 4);
  };
  draw = () => {
    clearTimeout(rest);
    rest = setTimeout(() => requestAnimationFrame(() => { rest = 0; refine(); }), 150);
    if (!asked) { asked = true; requestAnimationFrame(() => { asked = false; frame(false); }); }
  };
  // The canvas gets its size from the page around it, and may get another one at any time.
  new ResizeObserver(() => draw()).observe(canvas);
} else {
  $("scale").textContent = "This browser draws no path in space (WebGL 2 is off).";
}

