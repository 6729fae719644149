// The mouse turns, moves (shift, or the right button) and zooms; a click sets the cursor. Views, layers and tools.
const pointers = new Map();
let moved = 0, spread = 0;
canvas.addEventListener("pointerdown", e => { pointers.set(e.pointerId, e); canvas.setPointerCapture(e.pointerId); moved = 0; spread = 0; });
canvas.addEventListener("pointermove", e => {
  const before = pointers.get(e.pointerId);
  if (!before) return;
  const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
  moved += Math.abs(dx) + Math.abs(dy);
  pointers.set(e.pointerId, e);
  if (!dx && !dy) return;
  view.fit = null;
  if (pointers.size === 2) {
    const [a, b] = [...pointers.values()], now = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
    if (spread) view.scale *= now / spread;
    spread = now; view.x += dx / 2; view.y += dy / 2;
  } else if (e.shiftKey || e.buttons & 2) { view.x += dx; view.y += dy; }
  else { view.turn += dx * 0.008; view.tilt = Math.max(0, Math.min(Math.PI / 2, view.tilt + dy * 0.008)); }
  draw();
});
const release = e => {
  pointers.delete(e.pointerId);
  if (e.type === "pointerup" && moved < 4) {
    const box = canvas.getBoundingClientRect(), at = [e.clientX - box.left, e.clientY - box.top];
    let best = Infinity, found = cursor;
    for (let i = cut.from; i < cut.to; i += thin) {
      const p = place(i);
      if (p[2] < cut.low || p[2] > cut.high) continue;
      const q = project(p), far = (q[0] - at[0]) ** 2 + (q[1] - at[1]) ** 2;
      if (far < best) { best = far; found = i; }
    }
    setCursor(found, true);
  }
};
canvas.addEventListener("pointerup", release);
canvas.addEventListener("pointercancel", release);
canvas.addEventListener("contextmenu", e => e.preventDefault());
canvas.addEventListener("wheel", e => {
  e.preventDefault();
  const box = canvas.getBoundingClientRect(), by = Math.exp(-e.deltaY * 0.0015);
  const x = e.clientX - box.left - box.width / 2, y = e.clientY - box.top - box.height / 2;
  view.x = x + (view.x - x) * by; view.y = y + (view.y - y) * by; view.scale *= by; view.fit = null;
  draw();
}, { passive: false });
canvas.addEventListener("keydown", e => {
  const step = { ArrowLeft: -1, ArrowRight: 1, PageUp: -100, PageDown: 100 }[e.key];
  if (step) { e.preventDefault(); setCursor(cursor + step, true); }
});
// The whole path from there, as large as it fits.
document.querySelectorAll("[data-view]").forEach(button => button.addEventListener("click", () => {
  view.fit = button.dataset.view;
  draw();
}));
["moved", "programmed", "filtered", "corners"].forEach(id => $(id) && $(id).addEventListener("change", () => draw()));
const layersChanged = () => {
  let [a, b] = [+$("low").value, +$("high").value].sort((p, q) => p - q);
  const z = share => low[2] + (high[2] - low[2]) * share / 1000;
  cut.low = (z(a) - middle[2]) / size - 1e-6; cut.high = (z(b) - middle[2]) / size + 1e-6;
  $("layer").textContent = dims[2] ? `${dims[2]} ${(z(a) * STEP).toFixed(2)} … ${(z(b) * STEP).toFixed(2)} ${unit}` : "";
  draw();
};
$("low").addEventListener("input", layersChanged); $("high").addEventListener("input", layersChanged);
if (facts.tools.length) {
  const tools = facts.tools[0][0] > 0 ? [[0, null], ...facts.tools] : facts.tools;
  $("tool").append(new Option("all", ""), ...tools.map(([at, tool], i) => new Option(tool === null ? "before T" : `T${tool}`, i)));
  $("tool").addEventListener("change", () => {
    const i = $("tool").value;
    cut.from = i === "" ? 0 : tools[i][0]; cut.to = i === "" || !tools[+i + 1] ? samples : tools[+i + 1][0];
    draw();
  });
} else $("toollabel").remove();

