// Data of the page: columns of numbers, the program text, and what finds a block by its sample.
const $ = id => document.getElementById(id);
const facts = JSON.parse($("json").textContent);
const summary = facts.summary;

// Data: base64 of gzip; columns of differences are added up.
const unpack = async id => {
  const text = atob($(id).textContent);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  $(id).textContent = "";
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
};
const columns = {};
{
  const view = new DataView(await unpack("data"));
  let at = 0;
  for (const [name, kind, count] of facts.columns) {
    let column;
    if (kind === "i2") {
      column = new Int16Array(count);
      for (let i = 0, sum = 0; i < count; i++, at += 2) column[i] = sum = (sum + view.getInt16(at, true)) << 16 >> 16;
    } else if (kind === "i4") {
      column = new Int32Array(count);
      for (let i = 0, sum = 0; i < count; i++, at += 4) column[i] = sum = sum + view.getInt32(at, true) | 0;
    } else {
      column = new Uint32Array(count);
      for (let i = 0; i < count; i++, at += 4) column[i] = view.getUint32(at, true);
    }
    columns[name] = column;
  }
}
const text = new TextDecoder().decode(await unpack("text")).split(/\r\n|\n|\r/);
const STEP = 1e-4, unit = facts.unit, samples = columns.v.length;
const { entry, entered, line, n, feed, tolerance } = columns;

// The last index whose value is not above the one given, in a column that rises.
const last = (column, value) => {
  let low = 0, high = column.length;
  while (low < high) {
    const middle = low + high >> 1;
    if (column[middle] <= value) low = middle + 1; else high = middle;
  }
  return low - 1;
};
const blockAt = sample => entered[Math.max(0, last(entry, sample))];
const sampleOf = block => {
  const i = last(entered, block);
  return i < 0 ? 0 : entry[entered[i] < block && i + 1 < entry.length ? i + 1 : i];
};
const clock = s => {
  const whole = Math.floor(s), two = v => String(v).padStart(2, "0");
  return `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)}`;
};

$("title").textContent = summary.program;
$("facts").textContent = `${summary.program_time_s.toFixed(3)} s (${clock(summary.program_time_s)}) · ` +
  `${summary.blocks} blocks · ${summary.path_mm.toFixed(1)} ${unit} of path · ${summary.machine} · slope ${summary.slope}` +
  (facts.stride > 1 ? ` · every ${facts.stride}th tick shown` : "");

