"""Two real senders stream jobs to a controller at a pseudo terminal: pygrbl-streamer and grbl-streamer.

python python.py LINES COMMAND...

COMMAND runs the controller and names its terminal in its first output, as `glidepath serve --pty` does and QEMU with
`-serial pty`. It runs anew for each sender.
Needs `pip install pygrbl-streamer==1.0.5 grbl-streamer==2.0.2`. Ends with 0 if every line was acknowledged once, without an
error, and the machine stands where the job ends.
"""
import os
import re
import subprocess
import sys
import tempfile
import threading
import time


def job(lines):
    """A head, many short lines, a tail."""
    text = ["G21 G90 G94 G17", "M3 S1000"]
    text += [f"G1 X{i % 17 / 4:.3f} Y{i % 23 / 5:.3f} F6000" for i in range(lines)]
    return text + ["G1 X1.5 Y2.25 Z-0.5", "M5"]


def start(command):
    """The controller, and the name of its terminal."""
    child = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    for line in child.stdout:
        if found := re.search(r"/dev/\S+", line):
            return child, found.group()
    raise SystemExit(f"{command}: no terminal")


def place(text):
    """The last machine position that was reported."""
    found = re.findall(r"MPos:([-0-9.]+),([-0-9.]+),([-0-9.]+)", text)
    return tuple(float(axis) for axis in found[-1]) if found else None


def pygrbl(path, lines):
    import pygrbl_streamer

    errors, heard = [], []
    sender = pygrbl_streamer.GrblStreamer(path)
    sender.error_callback = errors.append
    sender.receive_callback = heard.append
    sender.connect()
    with tempfile.NamedTemporaryFile("w", suffix=".nc", delete=False) as file:
        file.write("\n".join(job(lines)) + "\n")
    done = sender.send_file(file.name)
    os.unlink(file.name)
    acknowledged, end = sum(line.strip() == "ok" for line in heard), place("\n".join(heard))
    functions(sender, heard)
    sender.disconnect()
    # Its own `$X` at connect has an answer too.
    once = 0 <= acknowledged - len(job(lines)) <= 1
    return done and not errors and once, errors[:3], acknowledged, end


def functions(sender, heard):
    """Hold, resume, an override wrapped in UTF-8, jog, cancel, a reset in motion. Raises what does not hold."""
    def report(begins, has=""):
        until = time.time() + 10
        while time.time() < until:
            before = len(heard)
            sender.realtime(b"?")
            time.sleep(0.03)
            for line in heard[before:]:
                if line.startswith("<" + begins) and has in line:
                    return place(line)
        raise AssertionError(f"never {begins} {has}: {heard[-3:]}")

    job = threading.Thread(target=sender.stream, args=(["G21 G90", "G1 X100 F400", "G1 X0 F400"],))
    job.start()
    report("Run")
    sender.pause()
    held = report("Hold:0")
    time.sleep(0.2)
    assert report("Hold:0") == held, "moves in a hold"
    sender.resume()
    report("Run")
    for byte in (b"\xc2", b"\x91", b"\xc2", b"\x96", b"\xc2", b"\x9b"):
        sender.realtime(byte)
    report("Run", "|Ov:110,50,90")
    job.join()
    for byte in (b"\x90", b"\x95", b"\x99"):
        sender.realtime(byte)
    assert report("Idle")[0] == 0
    assert sender.command("$J=G91 X50 F200")
    report("Jog")
    sender.realtime(b"\x85")
    jogged = report("Idle")
    assert 0 < jogged[0] < 50, jogged
    job = threading.Thread(target=sender.stream, args=(["G1 X120 F400"],))
    job.start()
    report("Run")
    sender.stop()
    job.join()
    stopped = report("Idle")
    assert jogged[0] < stopped[0] < 120, stopped
    for line in ("G91", "G0 X1", "G90", "G4 P0"):
        assert sender.command(line)
    assert abs(report("Idle")[0] - stopped[0] - 1) < 0.0015, "the position is lost"


def streamer(path, lines):
    from grbl_streamer import GrblStreamer

    completed, ready, errors, states = threading.Event(), threading.Event(), [], []

    def told(event, *data):
        if event == "on_job_completed" and ready.is_set():
            completed.set()
        if event in ("on_error", "on_alarm"):
            errors.append(data)
        if event == "on_stateupdate":
            states.append(data)

    sender = GrblStreamer(told)
    sender.cnect(path, 115200)
    time.sleep(2.5)
    ready.set()
    sender.poll_start()
    sender.write("\n".join(job(lines)))
    sender.job_run()
    done = completed.wait(120)
    # The last lines are acknowledged while they wait in the planner.
    for _ in range(300):
        if states and states[-1][0] == "Idle":
            break
        time.sleep(0.1)
    sender.poll_stop()
    last = states[-1] if states else None
    sender.disconnect()
    return done and not errors, errors[:3], len(job(lines)), tuple(last[1]) if last else None


def main():
    lines, command = int(sys.argv[1]), sys.argv[2:]
    failed = False
    for name, talk in [("pygrbl-streamer", pygrbl), ("grbl-streamer", streamer)]:
        child, path = start(command)
        begun = time.time()
        try:
            good, errors, acknowledged, end = talk(path, lines)
        finally:
            child.terminate()
            child.wait()
        good = good and end == (1.5, 2.25, -0.5)
        failed |= not good
        print(f"{name}: {'good' if good else 'BAD'}, {len(job(lines))} lines, {acknowledged} answers, end {end}, "
              f"{time.time() - begun:.1f} s {errors or ''}")
    return 1 if failed else 0


if __name__ == "__main__":
    # Threads of a sender may outlive it.
    code = main()
    sys.stdout.flush()
    os._exit(code)
