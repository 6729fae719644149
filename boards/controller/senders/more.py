"""Two more real senders stream a job to a controller at a pseudo terminal: plotdeck and gantrix.

python more.py LINES COMMAND...

COMMAND runs the controller and names its terminal in its first output, as `glidepath serve --pty` does and QEMU with
`-serial pty`. It runs anew for each sender.
Needs `pip install plotdeck==1.0.0 gantrix==0.1.1`. plotdeck counts characters and asks for reports, gantrix sends line by
line. Ends with 0 if every line was acknowledged once, without an error, and the machine stands where the job ends.
"""
import contextlib
import io
import os
import sys
import time

from python import job, place, start

END = (1.5, 2.25, -0.5)


def wait(holds, seconds, what):
    until = time.time() + seconds
    while not holds():
        if time.time() > until:
            raise AssertionError(what)
        time.sleep(0.02)


def plotdeck(path, lines):
    """The controller of the program without its window: job, hold, resume, jog, cancel, stop in motion, unlock."""
    from plotdeck.core.controller import MachineController

    heard, errors, ends, settings = [], [], [], []
    machine = MachineController()
    machine.on_line = lambda kind, text: heard.append(text)
    machine.on_alarm = lambda code, text: errors.append((code, text))
    machine.on_stream_error = lambda line, code, text: errors.append((line, code, text))
    machine.on_command_error = lambda code, text: errors.append((code, text))
    machine.on_job_finished = ends.append
    machine.on_settings = settings.append
    machine.connect(path)
    wait(lambda: machine._transport.is_open, 5, "not open")
    machine.reset()
    wait(lambda: machine.connected, 10, "no banner")
    machine.unlock()
    time.sleep(0.3)
    text = job(lines)
    before = sum(line.strip() == "ok" for line in heard)
    assert machine.run_text("\n".join(text)), "does not start"
    wait(lambda: ends, 300, "no end")
    acknowledged = sum(line.strip() == "ok" for line in heard) - before
    idle = lambda: machine.status.state.lower().startswith("idle")
    wait(lambda: idle() and place("\n".join(heard[-3:])) == END, 60, f"not at the end: {heard[-3:]}")
    assert ends == ["completed"] and acknowledged == len(text), (ends, acknowledged)
    # A hold, a resume, and a reset in motion.
    state = lambda name: lambda: machine.status.state.lower().startswith(name)
    assert machine.run_text("G21 G90\nG1 X300 F400\nG1 X0 F400")
    wait(state("run"), 5, "never runs")
    machine.hold()
    wait(state("hold"), 5, "never holds")
    machine.cycle_start()
    wait(state("run"), 5, "never runs again")
    machine.stop()
    wait(idle, 10, "never idle behind a stop")
    assert machine.jog("X", 50, 200)
    wait(state("jog"), 5, "never jogs")
    machine.jog_cancel()
    wait(idle, 5, "never idle behind a jog")
    machine.disconnect()
    return acknowledged, END, errors


def gantrix(path, lines):
    """Line by line, with CR LF CR LF at connect."""
    from gantrix.transport import GrblTransport

    transport = GrblTransport(path, boot_delay=1)
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        transport.connect()
        text = job(lines)
        for line in text + ["G4 P0.01"]:
            transport.send(line)
        transport._ser.write(b"?")
        report = transport._ser.readline().decode()
        # A stop in motion, and a new connection.
        transport.send("G1 X100 F400")
        transport.emergency_stop()
        time.sleep(0.5)
        transport._ser.reset_input_buffer()
        transport.send("$X")
        transport.disconnect()
    errors = [line for line in said.getvalue().splitlines() if "error" in line]
    return len(text), place(report), errors


def main():
    lines, command = int(sys.argv[1]), sys.argv[2:]
    failed = False
    for name, talk in [("plotdeck", plotdeck), ("gantrix", gantrix)]:
        child, path = start(command)
        begun = time.time()
        try:
            answers, end, errors = talk(path, lines)
            good = end == END and not errors and answers == len(job(lines))
            told = f"{len(job(lines))} lines, {answers} answers, end {end} {errors[:3] or ''}"
        except (AssertionError, OSError) as fault:
            good, told = False, f"{type(fault).__name__} {fault}"
        finally:
            child.terminate()
            child.wait()
        failed |= not good
        print(f"{name}: {'good' if good else 'BAD'}, {told}, {time.time() - begun:.1f} s", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    # Threads of a sender may outlive it.
    code = main()
    sys.stdout.flush()
    os._exit(code)
