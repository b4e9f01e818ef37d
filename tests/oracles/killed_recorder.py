#!/usr/bin/env python3
"""Kills the window while it records, and damages recordings.

Each round opens the window on a display of Xvfb, lets it record for a random time and kills
it (SIGKILL). Its recording must replay without a difference, and it must have been written to
within the last second before the kill: on a busy computer the machine is slower than the
clock. Then every byte of one recording (or every N-th one) gets
a flipped bit; `replay` must notice each.

usage: killed_recorder.py PROGRAM [--times N] [--flips N]
"""
import argparse, os, random, re, shutil, signal, subprocess, sys, tempfile, time

P = argparse.ArgumentParser()
P.add_argument('program')
P.add_argument('--times', type=int, default=200)
P.add_argument('--flips', type=int, default=1000)
P.add_argument('--display', type=int, default=93)
A = P.parse_args()
# A hand-over a second, a turn of the kernel thread, and a busy computer, s.
SLACK_S = 1.6
HASH = re.compile(r'(?:(\d+):)?(\d+):(\d+\.?\d*) of machine time, (\d+) inputs, (\d+) states')


def replay(path):
    """Exit code, replayed seconds, equal states, whole output."""
    done = subprocess.run([A.program, 'replay', path, '--lang', 'en'], capture_output=True,
                          text=True, timeout=600)
    found = HASH.search(done.stdout)
    if not found:
        return done.returncode, 0.0, 0, done.stdout + done.stderr
    hours, minutes, seconds, _, equal = found.groups()
    total = int(hours or 0) * 3600 + int(minutes) * 60 + float(seconds)
    return done.returncode, total, int(equal), done.stdout + done.stderr


def record_and_kill(folder, generator):
    """Opens the window and kills it. Returns the recording and its age at the kill, s."""
    window = subprocess.Popen([A.program, '--data', folder, '--first-start=off'],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              env=dict(os.environ, DISPLAY=f':{A.display}', WAYLAND_DISPLAY=''))
    recordings = os.path.join(folder, 'recordings')
    before = set(os.listdir(recordings)) if os.path.isdir(recordings) else set()
    deadline, new = time.time() + 60, set()
    while not new and time.time() < deadline and window.poll() is None:
        new = set(os.listdir(recordings)) - before if os.path.isdir(recordings) else set()
        time.sleep(0.005)
    if len(new) != 1:
        raise SystemExit(f'no recording begins: {new}, exit code {window.poll()}')
    path = os.path.join(recordings, new.pop())
    # The first second is handed over when the file is created.
    while os.path.getsize(path) == 0:
        time.sleep(0.005)
    time.sleep(generator.uniform(0.0, 4.0))
    killed = time.time()
    window.send_signal(signal.SIGKILL)
    window.wait()
    return path, killed - os.path.getmtime(path)


def check_kills(folder, generator):
    worst, equal, total = 0.0, 0, 0.0
    for round in range(A.times):
        path, age = record_and_kill(folder, generator)
        code, reached, states, text = replay(path)
        ended_within = 'ends within a frame' in text
        if not (code == 0 or ended_within) or age > SLACK_S:
            print(text)
            raise SystemExit(f'round {round}: {age:.2f} s old, replays to {reached:.2f} s')
        worst, equal, total = max(worst, age), equal + states, total + reached
    print(f'{A.times} kills: each replays ({total:.0f} s of machine time, {equal} states '
          f'compared); at most {worst:.2f} s are missing')
    return path


def check_flips(path, folder, generator):
    data = open(path, 'rb').read()
    damaged = os.path.join(folder, 'damaged.gskrec')
    positions = sorted(generator.sample(range(len(data)), min(A.flips, len(data))))
    for position in positions:
        changed = bytearray(data)
        changed[position] ^= 1 << generator.randrange(8)
        open(damaged, 'wb').write(changed)
        code, *_ = replay(damaged)
        if code == 0:
            raise SystemExit(f'a flipped bit in byte {position} of {len(data)} is not noticed')
    print(f'{len(positions)} flipped bits in {len(data)} bytes: each is noticed')


def main():
    generator = random.Random(1)
    server = subprocess.Popen(['Xvfb', f':{A.display}', '-screen', '0', '1024x768x24'],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    folder = tempfile.mkdtemp(prefix='killed-recorder-')
    try:
        time.sleep(1)
        path = check_kills(folder, generator)
        check_flips(path, folder, generator)
    finally:
        server.terminate()
        server.wait()
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == '__main__':
    sys.exit(main())
