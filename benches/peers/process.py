"""What a process costs: its time, its memory."""
import os
import subprocess
import time


def spawn(command, folder):
    return subprocess.Popen([str(c) for c in command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)


def check(command, status, said):
    if status != 0:
        raise RuntimeError(f'{" ".join(map(str, command))} ended with {status}:\n{said.decode(errors="replace")[-2000:]}')


def cost(command, folder):
    """Seconds of cpu, user and system, of all its threads, and seconds on the clock, of one whole run."""
    start = time.perf_counter()
    child = spawn(command, folder)
    said = child.stderr.read()  # until it closes it, so at the latest at its end
    _, status, used = os.wait4(child.pid, 0)
    wall = time.perf_counter() - start
    child.returncode = os.waitstatus_to_exitcode(status)
    check(command, child.returncode, said)
    return used.ru_utime + used.ru_stime, wall


def peak(command, folder):
    """Most memory that it ever held, in bytes: the kernel's own high-water mark, read until it ends. The one that `wait4` gives
    is no use for small programs: it is never less than what this interpreter holds."""
    child = subprocess.Popen([str(c) for c in command], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    most = 0
    while child.poll() is None:
        try:
            with open(f'/proc/{child.pid}/status') as file:
                most = max([most, *(int(line.split()[1]) for line in file if line.startswith('VmHWM:'))])
        except OSError:
            pass  # it ended meanwhile
        time.sleep(0.0005)
    check(command, child.returncode, b'')
    return most * 1024


def median(numbers):
    a = sorted(numbers)
    return (a[(len(a) - 1) // 2] + a[len(a) // 2]) / 2
