#!/usr/bin/env python3
"""Moves a real firmware by the window and takes away what the operator's hand depends on:
the display server, the window manager, the line to the display, the program, the guard.
Prints how far an axis ran on, and what the control said.

A board is a folder with `bench.log` (lines `STAT X pos N ... Z pos N ...` whenever the word
`stat` is written to `ctl`) and a port. Needs Xvfb, xdotool, openbox; nothing of the window.

usage: unwanted_motion.py --program P --board grbl|hal|kl --run DIR --port PORT
                          --machine FILE [--times N] [--load N] SCENE...
scenes: freeze rapid wheel mouse manager stall stop3 stoprapid stopcut xkill xkilljog
"""
import argparse, glob, os, re, select, shutil, signal, socket, subprocess, sys, threading, time

P = argparse.ArgumentParser()
for name in ('program', 'board', 'run', 'port', 'machine'):
    P.add_argument('--' + name, required=True)
P.add_argument('--times', type=int, default=3)
P.add_argument('--load', type=int, default=0)
P.add_argument('--display', type=int, default=91)
P.add_argument('--first', action='store_true', help='display and program go before all other work of the computer')
P.add_argument('--seconds', type=float, default=6)
P.add_argument('--out', default=None)
P.add_argument('scenes', nargs='+')
A = P.parse_args()
FIRST = ['chrt', '-r', '5'] if A.first else []
LINE = A.board != 'kl'
# Pulses a mm of the slide (X in radius): gear 1/5.
PULSES = {'X': 400.0, 'Z': 200.0}
WORK = os.path.join(A.run, 'win')
os.makedirs(WORK, exist_ok=True)
SET = ['--param', '17=5', '--param', '18=5', '--param', '11.2=1', '--param', '1.3=1']


class Board:
    """The board of a bench: where its slides are, by its counted edges."""

    def word(self, word):
        if A.board != 'hal':
            with open(A.run + '/ctl', 'w') as f:
                f.write(word + '\n')

    def at(self):
        log = A.run + '/bench.log'
        before = os.path.getsize(log)
        if A.board == 'hal':
            os.kill(int(open(A.run + '/pid').read()), signal.SIGUSR1)
            pattern = r'STEPS (.*)'
        else:
            self.word('stat')
            pattern = r'STAT (.*)'
        for _ in range(1000):
            time.sleep(.004)
            with open(log, errors='replace') as f:
                f.seek(before)
                found = re.search(pattern + r'\n', f.read())
            if found:
                place = re.findall(r'\b([XZ]) pos (-?\d+)', found[1])
                return {axis: int(at) for axis, at in place}
        raise SystemExit('the bench does not answer')

    def place(self):
        for axis, at in (('X', 0), ('Z', 0 if LINE else 1000), ('Y', 0)):
            if axis != 'Y' or A.board == 'grbl':
                self.word(f'place {axis} {at}')


class Stalls(threading.Thread):
    """A network to the display that stands still for a while."""

    def __init__(self, near, far):
        super().__init__(daemon=True)
        self.near, self.far, self.still = near, far, False
        self.server = socket.create_server(('127.0.0.1', near))

    def run(self):
        while True:
            client, _ = self.server.accept()
            display = socket.create_connection(('127.0.0.1', self.far))
            for pair in ((client, display), (display, client)):
                threading.Thread(target=self.carry, args=pair, daemon=True).start()

    def carry(self, source, sink):
        while True:
            try:
                data = source.recv(65536)
                while self.still:
                    time.sleep(.002)
                if not data:
                    sink.shutdown(socket.SHUT_WR)
                    return
                sink.sendall(data)
            except OSError:
                return


class Window:
    def __init__(self, board, network=False, manager=False, program=None):
        self.board = board
        self.name = f':{A.display}'
        server = ['Xvfb', self.name, '-noreset', '-ac', '-screen', '0', '1280x1000x24']
        if network:
            server += ['-listen', 'tcp']
        self.server = subprocess.Popen(FIRST + server, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(1.5)
        self.env = dict(os.environ, DISPLAY=self.name, LIBGL_ALWAYS_SOFTWARE='1', HOME=WORK)
        self.env.pop('WAYLAND_DISPLAY', None)
        self.manager = None
        if manager:
            self.manager = subprocess.Popen(FIRST + ['openbox'], env=self.env, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(1)
        self.network = None
        env = self.env
        if network:
            self.network = Stalls(6000 + A.display + 50, 6000 + A.display)
            self.network.start()
            env = dict(env, DISPLAY=f'127.0.0.1:{A.display + 50}')
        self.data = WORK + '/data-' + A.board
        shutil.rmtree(self.data, ignore_errors=True)
        with open(WORK + '/nothing.txt', 'w') as f:
            f.write('wait 300ms\n')
        subprocess.run([A.program, 'operate', WORK + '/nothing.txt', '--data', self.data] + SET, check=True, stdout=subprocess.DEVNULL)
        board.place()
        command = [A.program, '--data', self.data, '--lang', 'en', '--machine', A.machine, '--link', A.port]
        if program:
            command += ['--program', program]
        self.process = subprocess.Popen(FIRST + command, env=env, stdout=open(self.data + '/stdout', 'w'), stderr=open(self.data + '/stderr', 'w'))
        begun = time.time()
        self.window = None
        while not self.window and time.time() - begun < 90 and self.process.poll() is None:
            time.sleep(.3)
            found = self.do('search', '--pid', str(self.process.pid), '--onlyvisible', '--name', 'GSK').split()
            self.window = found[-1] if found else None
        time.sleep(4)
        self.focus()
        self.keys('Escape')
        time.sleep(1.5)

    def do(self, *words):
        return subprocess.run(FIRST + ['xdotool', *words], env=self.env, capture_output=True, text=True).stdout

    def focus(self):
        self.do('windowactivate' if self.manager else 'windowfocus', self.window)
        time.sleep(.3)

    def keys(self, *keys):
        self.do('key', '--delay', '80', *keys)

    def yields(self):
        """From now on program and holder compete with the other work of the computer."""
        own = str(self.process.pid)
        children = subprocess.run(['pgrep', '-P', own], capture_output=True, text=True).stdout.split()
        for process in [own, *children]:
            subprocess.run(['chrt', '-a', '-o', '-p', '0', process], capture_output=True)

    def stands(self, longest=40, still=2.0):
        last, since, begun = None, time.time(), time.time()
        while time.time() - begun < longest:
            now = self.board.at()
            if now != last:
                last, since = now, time.time()
            if time.time() - since > still:
                return last
            time.sleep(.1)
        return last

    def home(self):
        self.keys('ctrl+4')
        time.sleep(.6)
        for key in ('Down', 'Right'):
            self.do('keydown', 'ctrl', 'keydown', key)
            time.sleep(.4)
            self.do('keyup', key, 'keyup', 'ctrl')
            self.stands(still=4)

    def log(self):
        text = ''
        for name in sorted(glob.glob(self.data + '/log/*')):
            text += open(name, errors='replace').read()
        return text

    def alarms(self, since=0):
        lines = [line for line in self.log()[since:].splitlines() if re.search(r'alarm|gone|stopped', line)]
        return ' | '.join(re.sub(r'^\S+\s+', '', line)[:150] for line in lines[-3:])

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGCONT)
            self.process.terminate()
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
        for one in (self.manager, self.server):
            if one:
                one.send_signal(signal.SIGCONT)
                one.kill()
                one.wait()
        time.sleep(1)


def watch(board, axis, seconds):
    """Where the axis was when it began, where it ended, and when it last moved."""
    begun = time.time()
    first = last = board.at()[axis]
    moved = 0.0
    while time.time() - begun < seconds:
        now = board.at()[axis]
        if now != last:
            last, moved = now, time.time() - begun
        time.sleep(.008)
    return first, last, moved


def moves(board, axis, longest=6.0):
    """Waits until the axis has moved for a while."""
    begun, stood = time.time(), board.at()[axis]
    while time.time() - begun < longest:
        time.sleep(.05)
        if abs(board.at()[axis] - stood) > PULSES[axis] * .3:
            return True
    return False


def report(scene, number, first, last, moved, axis, note=''):
    text = f'{A.board}\t{scene}\t{number}\t{abs(last - first) / PULSES[axis]:.3f} mm\t{moved:.2f} s\t{note}'
    print(text, flush=True)
    if A.out:
        with open(A.out, 'a') as f:
            f.write(text + '\n')


def jog(window, rapid=False, key='Left'):
    """The mode anew: RESET leaves manual rapid on, a change of the mode does not."""
    window.keys('ctrl+3')
    time.sleep(.3)
    window.keys('ctrl+6')
    time.sleep(.4)
    if rapid:
        window.keys('ctrl+r')
        time.sleep(.3)
    window.do('keydown', 'ctrl', 'keydown', key)


def unjog(window, key='Left'):
    window.do('keyup', key, 'keyup', 'ctrl')


def held_scenes(scene, board):
    network = scene == 'stall'
    window = Window(board, network=network, manager=scene == 'manager')
    try:
        window.home()
        for number in range(A.times):
            window.keys('Escape')
            time.sleep(1.5)
            if window.process.poll() is not None:
                print('the program has ended', open(window.data + '/stderr').read()[-400:])
                return
            mark = len(window.log())
            axis, key = 'Z', 'Left'
            if scene == 'wheel':
                window.keys('ctrl+5')
                time.sleep(.3)
                window.keys('alt+z')
                time.sleep(.3)
                window.keys('alt+8')
                time.sleep(.3)
                window.do('keydown', 'bracketleft')
                time.sleep(1.5)
            else:
                jog(window, rapid=scene == 'rapid', key=key)
            moving = moves(board, axis)
            if scene in ('freeze', 'rapid', 'wheel'):
                window.server.send_signal(signal.SIGSTOP)
                first, last, moved = watch(board, axis, A.seconds)
                window.server.send_signal(signal.SIGCONT)
            elif scene == 'manager':
                # A key of the window manager takes the keyboard away, and it does not let
                # go: the release of the jog key is never heard by the window.
                window.manager.send_signal(signal.SIGSTOP)
                window.do('keydown', 'alt', 'key', 'Tab')
                window.do('keyup', key, 'keyup', 'ctrl')
                first, last, moved = watch(board, axis, A.seconds)
                window.do('keyup', 'alt')
                window.manager.send_signal(signal.SIGCONT)
            elif scene == 'stall':
                window.network.still = True
                first, last, moved = watch(board, axis, .5)
                unjog(window, key)
                _, last, more = watch(board, axis, 2.5)
                moved = .5 + more if more else moved
                window.network.still = False
            time.sleep(1)
            ran = board.at()[axis]
            _, after, _ = watch(board, axis, 2)
            unjog(window, key)
            window.do('keyup', 'bracketleft')
            note = '' if moving else 'DID NOT MOVE BEFORE '
            if abs(after - last) > 0:
                note += f'MOVED AGAIN by {(after - last) / PULSES[axis]:.3f} mm '
            report(scene, number, first, last, moved, axis, note + window.alarms(mark))
            window.focus()
    finally:
        window.end()


LONG = 'O1;\nG50 X100 Z100;\nM03 S500;\nM08;\nG98 G01 X60 Z20 F%s;\nX100 Z100;\nX60 Z20;\nM05;\nM09;\nM30;\n'


def stopped(scene, board):
    """The program is stopped for some seconds, then goes on."""
    for number in range(A.times):
        with open(WORK + '/long.nc', 'w') as f:
            f.write(LONG % 900)
        window = Window(board, program=WORK + '/long.nc')
        try:
            window.home()
            mark = len(window.log())
            if scene == 'stopcut':
                window.keys('ctrl+2')
                time.sleep(.4)
                window.keys('F9')
                moves(board, 'Z', 15)
            else:
                window.keys('ctrl+6')
                time.sleep(.3)
                if scene == 'stoprapid':
                    window.keys('ctrl+r')
                    time.sleep(.3)
                window.do('keydown', 'ctrl', 'keydown', 'Left')
                moves(board, 'Z')
                time.sleep(.13 * (number % 7))
            before = board.at()['Z']
            window.process.send_signal(signal.SIGSTOP)
            first, last, moved = watch(board, 'Z', 3 if number % 2 == 0 else .6)
            stood = board.at()['Z']
            window.process.send_signal(signal.SIGCONT)
            _, after, _ = watch(board, 'Z', 3)
            unjog(window)
            note = f'AGAIN {abs(after - stood) / PULSES["Z"]:.3f} mm'
            report(scene, number, before, last, moved, 'Z', note + ' ' + window.alarms(mark))
        finally:
            window.end()


def killed(scene, board):
    """The display server is killed while a program, or a jog key, moves the board."""
    for number in range(A.times):
        with open(WORK + '/long.nc', 'w') as f:
            f.write(LONG % 900)
        window = Window(board, program=WORK + '/long.nc')
        load = []
        try:
            window.home()
            mark = len(window.log())
            load = [subprocess.Popen(['sh', '-c', 'while :; do :; done']) for _ in range(A.load)]
            time.sleep(2)
            if scene == 'xkilljog':
                jog(window)
            else:
                window.keys('ctrl+2')
                time.sleep(.4)
                window.keys('F9')
            moves(board, 'Z', 15)
            window.yields()
            time.sleep(.5)
            window.server.kill()
            first, last, moved = watch(board, 'Z', A.seconds)
            report(scene, number, first, last, moved, 'Z', f'load {A.load} exit {window.process.poll()} ' + window.alarms(mark))
        finally:
            for one in load:
                one.kill()
                one.wait()
            window.end()


def main():
    board = Board()
    for scene in A.scenes:
        if scene in ('stop3', 'stoprapid', 'stopcut'):
            stopped(scene, board)
        elif scene in ('xkill', 'xkilljog'):
            killed(scene, board)
        else:
            held_scenes(scene, board)


main()
