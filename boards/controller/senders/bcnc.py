"""bCNC without a display sends jobs to a controller: its own thread reads, counts and writes.

python bcnc.py LINES JOBS COMMAND...

COMMAND runs the controller. Its first output names the address or the terminal, as `glidepath serve --tcp 0` does and QEMU
with `-serial pty`. Needs `pip install bCNC==0.9.16`. Ends with 0 if each job came to its end without an error, at its place, and hold, resume,
overrides, jog, jog cancel and a reset in motion do what they should.
"""
import builtins
import os
import re
import subprocess
import sys
import tempfile
import time

builtins._ = str


def imported(home):
    """The modules of bCNC, with a configuration of their own."""
    os.environ["HOME"] = home
    import bCNC

    root = os.path.dirname(bCNC.__file__)
    for folder in ("", "lib", "controllers", "plugins"):
        sys.path.insert(0, os.path.join(root, folder))
    import CNC
    import Sender
    import Utils

    Utils.loadConfiguration(True)
    return CNC, Sender


def job(lines, seed):
    """A head, many short lines, and a place that only this job ends at."""
    text = ["G21 G90 G94 G17", "M3 S1000"]
    text += [f"G1 X{(i + seed) % 17 / 4:.3f} Y{i % 23 / 5:.3f} F6000" for i in range(lines)]
    return text + [f"G1 X1.5 Y2.25 Z{-0.25 * seed:.3f}", "M5"], (1.5, 2.25, -0.25 * seed)


def start(command):
    """The controller, and where bCNC connects to it."""
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for line in child.stdout:
        if found := re.search(r"tcp (\S+)", line):
            return child, "socket://" + found.group(1)
        if found := re.search(r"/dev/\S+", line):
            return child, found.group()
    raise SystemExit(f"{command}: no address")


class Talk:
    def __init__(self, command):
        self.child, address = start(command)
        self.home = tempfile.TemporaryDirectory()
        self.cnc, sender = imported(self.home.name)

        class Headless(sender.Sender):
            def disable(self): pass
            def enable(self): pass
            def event_generate(self, *_args, **_more): pass

        self.sender = Headless()
        self.sender.controllerSet("GRBL1")
        self.sender.open(address, 115200)
        self.vars = self.cnc.CNC.vars

    def wait(self, holds, seconds, what):
        until = time.time() + seconds
        while not holds():
            if time.time() > until or self.child.poll() is not None:
                raise SystemExit(f"bCNC: {what}: state {self.vars['state']}, at {self.place()}, error {self.vars['errline']!r}")
            time.sleep(0.02)

    def state(self, *names):
        self.wait(lambda: any(self.vars["state"].startswith(name) for name in names), 20, f"never {names}")

    def place(self):
        return tuple(round(float(self.vars[axis]), 3) for axis in ("mx", "my", "mz"))

    def run(self, text):
        """Starts a job as the program does. How many lines it counts."""
        path = os.path.join(self.home.name, "job.nc")
        with open(path, "w") as file:
            file.write("\n".join(text) + "\n")
        s = self.sender
        s.load(path)
        s.initRun()
        # In the order of the program: its thread sends and counts from here on.
        s._runLines, s._gcount = sys.maxsize, 0
        paths = s.gcode.compile(s.queue, lambda: False)
        s._runLines = len(paths) + 1
        s.queue.put((self.cnc.WAIT,))
        return s._runLines

    def end(self, end, seconds=600):
        s = self.sender
        self.wait(lambda: s._gcount >= s._runLines and self.vars["state"] == "Idle" or self.vars["errline"], seconds, "no end")
        if self.vars["errline"]:
            raise SystemExit(f"bCNC: {self.vars['errline']}")
        s.runEnded()
        self.wait(lambda: self.place() == end, 5, f"not at {end}")

    def write(self, data):
        self.sender.serial_write(data)

    def ask(self, line):
        self.sender.sendGCode(line)


def functions(talk):
    """Hold, resume, overrides, jog, cancel, reset in motion."""
    talk.run(["G21 G90", "G1 X200 F400", "G1 X0 F400"])
    talk.state("Run")
    talk.sender.feedHold()
    talk.state("Hold")
    time.sleep(0.3)
    stands = talk.place()
    time.sleep(0.3)
    assert talk.place() == stands, "moves in a hold"
    talk.sender.resume()
    talk.state("Run")
    for name, wanted in (("Feed", 130), ("Rapid", 50), ("Spindle", 80)):
        talk.vars["_Ov" + name] = wanted
    talk.vars["_OvChanged"] = True
    # It steps until a report agrees, and may be a step beyond: so it is with Grbl.
    talk.wait(lambda: abs(talk.vars["OvFeed"] - 130) <= 10 and talk.vars["OvRapid"] == 50
              and abs(talk.vars["OvSpindle"] - 80) <= 10, 20, "overrides")
    talk.end((0.0, 2.25, stands[2]))
    for name in ("Feed", "Rapid", "Spindle"):
        talk.vars["_Ov" + name] = 100
    talk.write(b"\x90\x95\x99")
    talk.ask("$J=G91 X100 F200")
    talk.state("Jog")
    talk.write(b"\x85")
    talk.state("Idle")
    jogged = talk.place()
    assert 0 < jogged[0] < 100, jogged
    talk.ask("G1 X150 F400")
    talk.state("Run")
    talk.sender.softReset()
    time.sleep(1)
    talk.state("Idle")
    stopped = talk.place()
    assert jogged[0] < stopped[0] < 150, stopped
    # The position is exact behind the reset.
    talk.ask("G91")
    talk.ask("G0 X1")
    talk.ask("G90")
    talk.wait(lambda: abs(talk.place()[0] - stopped[0] - 1) < 0.0015, 10, "the position is lost")


def main():
    lines, jobs = (int(text) for text in sys.argv[1:3])
    begun = time.time()
    talk = Talk(sys.argv[3:])
    try:
        talk.state("Idle")
        sent = 0
        for seed in range(1, jobs + 1):
            text, end = job(max(lines * seed // jobs, 1), seed)
            talk.run(text)
            talk.end(end)
            sent += len(text)
        functions(talk)
        print(f"bCNC: good, {jobs} jobs, {sent} lines, hold, resume, overrides, jog, cancel, reset, {time.time() - begun:.1f} s")
    finally:
        talk.sender.thread = None
        talk.child.terminate()
        talk.child.wait()


if __name__ == "__main__":
    code = 0
    try:
        main()
    except (SystemExit, AssertionError) as fault:
        print(f"BAD: {fault}")
        code = 1
    sys.stdout.flush()
    # Threads of a sender may outlive it.
    os._exit(code)
