// cncjs without a browser sends jobs to a controller at a pseudo terminal, driven through its socket as a pendant does.
//
// node cncjs.mjs MODULES LINES JOBS COMMAND...
//
// COMMAND runs the controller and names its terminal in its first output, as `glidepath serve --pty` does and QEMU with
// `-serial pty`. MODULES is a folder in which `npm install cncjs@1.11.5 socket.io-client@2 jsonwebtoken` was run. Ends with 0 if each job
// came to its end without an error, at its place, and hold, resume, overrides, jog, jog cancel and a reset in motion do
// what they should.
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { mkdtempSync, writeFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { createServer } from "node:net";

const [modules, lines, jobs, ...controller] = process.argv.slice(2);
const require = createRequire(join(resolve(modules), "x.js"));
const io = require("socket.io-client"), jwt = require("jsonwebtoken");
const begun = Date.now(), folder = mkdtempSync(join(tmpdir(), "cncjs-"));
const pause = ms => new Promise(done => setTimeout(done, ms));
const children = [];
let state = {}, sender = {}, heard = [], errors = [];

const wait = async (holds, what, ms = 120000) => {
  for (const until = Date.now() + ms; !holds(); await pause(20)) {
    if (Date.now() > until) throw new Error(`${what}: ${JSON.stringify(state.status)} ${JSON.stringify(sender)} ${heard.slice(-5)}`);
  }
};
const free = () => new Promise(done => {
  const server = createServer().listen(0, "127.0.0.1", () => { const { port } = server.address(); server.close(() => done(port)); });
});
const terminal = child => new Promise((done, fail) => {
  let said = "";
  const hear = text => { said += text; const found = said.match(/(\/dev\/\S+)\s/); if (found) done(found[1]); };
  child.stdout.on("data", hear);
  child.stderr.on("data", hear);
  child.once("exit", () => fail(new Error(`no terminal: ${said}`)));
});
const start = (command, args, options) => { const child = spawn(command, args, options); children.push(child); return child; };
const place = () => ["x", "y", "z"].map(axis => +state.status?.mpos?.[axis]);
const active = () => state.status?.activeState;

const job = (count, seed) => {
  const text = ["G21 G90 G94 G17", "M3 S1000"];
  for (let i = 0; i < count; i++) text.push(`G1 X${((i + seed) % 17 / 4).toFixed(3)} Y${(i % 23 / 5).toFixed(3)} F6000`);
  return { text: text.concat([`G1 X1.5 Y2.25 Z${(-0.25 * seed).toFixed(3)}`, "M5"]), end: [1.5, 2.25, -0.25 * seed] };
};

const main = async () => {
  const [program, ...options] = controller;
  const path = await terminal(start(program, options, { stdio: ["ignore", "pipe", "pipe"] }));
  const config = join(folder, "cncrc"), secret = "a secret of this run", port = await free();
  writeFileSync(config, JSON.stringify({ secret }));
  const main = join(resolve(modules), "node_modules/cncjs/bin/cncjs");
  start(process.execPath, [main, "--config", config, "--port", port, "--host", "127.0.0.1", "--controller", "Grbl"],
    { stdio: "ignore", env: { ...process.env, HOME: folder } });
  const token = jwt.sign({ id: "", name: "cncjs-pendant" }, secret, { expiresIn: "1d" });
  const socket = io(`http://127.0.0.1:${port}`, { query: `token=${token}`, reconnectionDelay: 200 });
  const command = (...words) => socket.emit("command", path, ...words);
  socket.on("controller:state", (_, now) => { state = now; });
  socket.on("sender:status", now => { sender = now; });
  socket.on("serialport:read", line => { heard.push(line); if (/^(error|ALARM)/.test(line)) errors.push(line); });
  await wait(() => socket.connected, "cncjs does not start", 60000);
  await new Promise((done, fail) => socket.emit("open", path, { controllerType: "Grbl", baudrate: 115200 }, e => e ? fail(e) : done()));
  await wait(() => active() === "Idle", "never Idle", 20000);
  const run = async text => {
    await new Promise((done, fail) => command("gcode:load", "job.nc", text.join("\n"), {}, e => e ? fail(e) : done()));
    sender = {};
    command("gcode:start");
  };
  const ended = async end => {
    await wait(() => sender.finishTime > 0, "no end", 600000);
    if (sender.received !== sender.total || sender.sent !== sender.total) throw new Error(`${JSON.stringify(sender)}`);
    await wait(() => active() === "Idle" && place().every((at, k) => Math.abs(at - end[k]) < 0.0006), `not at ${end}`, 5000);
    command("gcode:stop");
    await wait(() => active() === "Idle", "never Idle", 5000);
  };
  let sent = 0;
  for (let seed = 1; seed <= +jobs; seed++) {
    const { text, end } = job(Math.max(Math.floor(lines * seed / jobs), 1), seed);
    await run(text);
    await ended(end);
    sent += text.length;
  }
  // Hold, resume, overrides.
  const z = place()[2];
  await run(["G21 G90", "G1 X200 F400", "G1 X0 F400"]);
  await wait(() => active() === "Run", "never Run", 5000);
  command("feedhold");
  await wait(() => active() === "Hold", "never Hold", 5000);
  await pause(600);
  const held = place();
  await pause(600);
  if (String(held) !== String(place())) throw new Error(`moves in a hold: ${held}, ${place()}`);
  command("cyclestart");
  await wait(() => active() === "Run", "never Run", 5000);
  command("feedOverride", 10);
  command("rapidOverride", 50);
  command("spindleOverride", -10);
  await wait(() => String(state.status?.ov) === "110,50,90", "overrides", 5000);
  command("feedOverride", 0);
  command("rapidOverride", 100);
  command("spindleOverride", 0);
  await ended([0, 2.25, z]);
  // A jog and its cancel, wrapped in UTF-8.
  command("gcode", "$J=G91 X100 F200");
  await wait(() => active() === "Jog", "never Jog", 5000);
  socket.emit("write", path, "\x85", {});
  await wait(() => active() === "Idle", "never Idle", 5000);
  const jogged = place();
  if (!(jogged[0] > 0 && jogged[0] < 100)) throw new Error(`jog: ${jogged}`);
  // A reset in motion: the position stays exact.
  command("gcode", "G1 X150 F400");
  await wait(() => active() === "Run", "never Run", 5000);
  command("reset");
  await wait(() => active() === "Idle", "never Idle", 5000);
  await pause(600);
  const stopped = place();
  if (!(stopped[0] > jogged[0] && stopped[0] < 150)) throw new Error(`reset: ${stopped}`);
  command("gcode", ["G91", "G0 X1", "G90"]);
  await wait(() => Math.abs(place()[0] - stopped[0] - 1) < 0.0015, "the position is lost", 5000);
  if (errors.length) throw new Error(`${errors}`);
  console.log(`cncjs: good, ${jobs} jobs, ${sent} lines, hold, resume, overrides, jog, cancel, reset, ${(Date.now() - begun) / 1000} s`);
};

let code = 0;
try { await main(); } catch (fault) { console.log(`BAD: cncjs: ${fault.message ?? fault}`); code = 1; }
children.forEach(child => child.kill());
rmSync(folder, { recursive: true, force: true });
process.exit(code);
