// NC lines: only those in view are in the document.
const list = $("lines"), all = $("all"), HEIGHT = 20;
// A browser limits the height of an element: beyond a million lines the list is scaled.
const tall = Math.min(text.length * HEIGHT, 15e6), lead = (text.length * HEIGHT - list.clientHeight) / Math.max(1, tall - list.clientHeight);
all.style.height = tall + "px";
let currentLine = 0;
const firstOf = new Map();
for (let b = line.length - 1; b >= 0; b--) firstOf.set(line[b], b);
const lines = () => {
  const offset = list.scrollTop * Math.max(1, lead), first = Math.max(0, Math.floor(offset / HEIGHT) - 5);
  const count = Math.ceil(list.clientHeight / HEIGHT) + 10;
  all.replaceChildren(...text.slice(first, first + count).map((content, i) => {
    const row = document.createElement("div"), number = document.createElement("i");
    row.className = "nc" + (first + i + 1 === currentLine ? " on" : "");
    row.style.top = (first + i) * HEIGHT - offset + list.scrollTop + "px";
    row.dataset.line = first + i + 1;
    number.textContent = first + i + 1;
    row.append(number, content);
    return row;
  }));
};
list.addEventListener("scroll", lines);
all.addEventListener("click", e => {
  const row = e.target.closest(".nc");
  if (!row) return;
  const block = firstOf.get(+row.dataset.line);
  if (block !== undefined) setCursor(sampleOf(block), false, true);
});
const scrollTo = number => {
  const top = list.scrollTop * Math.max(1, lead), y = (number - 1) * HEIGHT;
  if (y < top || y > top + list.clientHeight - HEIGHT) list.scrollTop = (y - list.clientHeight / 2) / Math.max(1, lead);
};

// One cursor: a sample; path, charts, lines and numbers follow.
const setCursor = (sample, follows, stays) => {
  cursor = Math.max(0, Math.min(samples - 1, sample));
  const block = blockAt(cursor), t = cursor * seconds;
  if (follows && (cursor < shown[0] || cursor > shown[1])) { shown = [0, samples - 1]; fill(); }
  currentLine = line[block] || 0;
  if (!stays && currentLine) scrollTo(currentLine);
  lines();
  const at = facts.axes.map(axis => `${axis} ${(columns["p" + axis][cursor] * STEP).toFixed(3)}`).join("  ");
  const share = ["s", "a", "j"].map((letter, i) => ["speed", "accel", "jerk"][i] + " " +
    moving.map(axis => `${axis} ${Math.round(Math.abs(columns[letter + axis][cursor]) / 10)} %`).join(" ")).join(" · ");
  const about = block < feed.length ? (feed[block] ? `feed ${(feed[block] / 1e3).toFixed(1)} ${unit}/s` : "rapid") : "";
  const corner = tolerance[block] ? ` · tolerance ${(tolerance[block] * STEP).toFixed(4)} ${unit}` : "";
  $("here").innerText = `${t.toFixed(3)} s (${clock(t)}) · ${(columns.v[cursor] / 1e3).toFixed(2)} ${unit}/s, ${about}${corner} · ` +
    `line ${currentLine || "of a called file"}${n[block] ? `, N${n[block]}` : ""}\n${at}\n${share}`;
  mark(); draw();
};

