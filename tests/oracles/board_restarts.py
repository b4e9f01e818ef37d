#!/usr/bin/env python3
"""Restarts at random blocks on real firmware: counted step edges against an uninterrupted run.

For each restart: one of the programs, a random line, `run --link --home --restart LINE` to get
the code, then the same with `--confirm CODE`. Every step edge of the firmware is logged. Compared
with an uninterrupted run of the same program on the same board: the commanded moves after the
block, the distances between the reversals of each axis in the rest of the path (one step), the
path of the rest (one step), and the position at the end (equal). A run that a busy computer has spoilt is repeated, and printed; with
a load above 4 on two processors these are most runs with Klipper.

Needs a folder with the images and configurations of the firmware bench (`firmware_bench.py`);
simulated AVR boards that run Grbl 1.1h and Klipper. Programs without threads, without G96 and G99:
Grbl has no index, and the index of the simulated ATmega2560 loses timer overflows. Feeds above 50
are multiplied by --feed-factor and limited, so that a run is short.

usage: board_restarts.py PROGRAM BENCH [--board grbl|klipper] [--number N] [--seed N] [--only NAME]
"""
import argparse, json, os, pathlib, random, re, subprocess, sys, time
from firmware_bench import (HOME, BenchBoard, commanded_turns, counted_turns, greatest_distance, path_points,
                            read_edges, read_positions)

P = argparse.ArgumentParser()
P.add_argument('program')
P.add_argument('bench')
P.add_argument('--board', choices=['grbl', 'klipper'], default='grbl')
P.add_argument('--port', type=int, default=9401)
P.add_argument('--number', type=int, default=25)
P.add_argument('--seed', type=int, default=1)
P.add_argument('--feed-factor', type=float, default=4)
P.add_argument('--longest', type=float, default=60, help='longest program that is used, s of machine time')
P.add_argument('--only', help='use the programs whose name contains this')
A = P.parse_args()
ROOT = pathlib.Path(__file__).parents[2]
SAMPLES = ROOT / 'assets/programs'
# Analog spindle, nose compensation, exact positions at corners: a restart begins from
# standstill, so that a rounded first corner would differ.
OPTIONS = ['--param', '1.4=1', '--param', '2.1=1', '--param', '7.3=1',
           '--offset', '01=0,0,0.4,3', '--offset', '02=1.2,-0.8,0.2,3', '--offset', '03=-2,1.5,0.3,3']
# Allowed distance of two paths, in steps: both axes may make their steps in another order.
REACH = 1
LEFT_OUT = re.compile(r'G0*(32|33|34|76|92|96|99)(?!\d)')


class Refused(Exception):
    """No way to the start point is free of collisions with the guessed part."""


def unescape(text):
    return text.replace('\\n', '\n').replace('\\"', '"')


def programs():
    """Name, text, subprograms and whether macro B is used: those of the restart test and the samples."""
    source = (ROOT / 'runner/tests/restart/programs.rs').read_text()
    table = source[source.index('pub const PROGRAMS'):]
    calls = re.split(r'\n    (plain|with_subprograms|with_macro_b)\(', table)[1:]
    for kind, body in zip(calls[::2], calls[1::2]):
        strings = re.findall(r'"((?:[^"\\]|\\.)*)"', body)
        if len(strings) >= 2:
            name, text, *subprograms = (unescape(text) for text in strings)
            yield name, text, subprograms, kind == 'with_macro_b'
    for path in sorted(SAMPLES.glob('0*.CNC')):
        text = path.read_text()
        # The run on a board ends at M00 without a terminal.
        text = re.sub(r'\bM00\b', 'G04 X0.1', text)
        yield path.stem, text, [(SAMPLES / 'O1031.CNC').read_text()], False


def scaled(text):
    """The program with faster feeds per minute."""
    # The restart waits for the spindle; that of the Klipper bench always turns at 600 r/min.
    if A.board == 'klipper':
        text = re.sub(r'S\d+', 'S600', text)
    return re.sub(r'F(\d+)(?![\d.])', lambda m: f'F{min(int(int(m[1]) * A.feed_factor), 1200)}'
                  if int(m[1]) >= 50 else m[0], text)


class Case:
    """A program, written to files, with its reference run on the board."""

    def __init__(self, folder, name, text, subprograms, macro_b):
        self.name = name
        self.folder = folder / re.sub(r'\W+', '-', name)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.main = self.folder / 'main.CNC'
        self.main.write_text(scaled(text))
        files = [str(self.main)]
        for subprogram in subprograms:
            number = re.match(r'\s*O(\d+)', subprogram)[1]
            path = self.folder / f'O{number}.CNC'
            path.write_text(scaled(subprogram))
            files.append(str(path))
        self.words = [*files, *OPTIONS, *(['--macro-b', 'on'] if macro_b else [])]
        self.reference = None

    def simulated(self):
        """Seconds of the program on the simulated lathe, and the lines of its moves."""
        done = subprocess.run([A.program, 'run', *self.words, '--json', '--moves', str(self.folder / 'sim.moves'),
                               '--positions', str(self.folder / 'sim.csv'),
                               '--lang', 'en'], stdin=subprocess.DEVNULL, capture_output=True, text=True)
        result = json.loads(done.stdout or '{}')
        if done.returncode or result.get('alarm'):
            return None
        positions = read_positions(self.folder / 'sim.csv')
        # The limit switches are 400 and 200 pulses beyond the start point.
        if any(max(row[axis] for row in positions) > positions[0][axis] + reach for axis, reach in ((1, 350), (2, 150))):
            return None
        moves = read_moves(self.folder / 'sim.moves')
        self.lines = sorted({move['line'] for move in moves if 'program' not in move})
        return result['time_s']

    def record(self, board, steps, words=()):
        """A run on the board: result, edges, commanded positions and moves."""
        log = self.folder / f'{steps}.log'
        done = board.run_referenced([*self.words, *words, '--positions', str(self.folder / f'{steps}.csv'),
                                     '--moves', str(self.folder / f'{steps}.moves')], log)
        end = board.stat()
        return done, read_edges(log), read_positions(self.folder / f'{steps}.csv'), \
            read_moves(self.folder / f'{steps}.moves'), end


def read_moves(path):
    with open(path) as text:
        return [json.loads(line) for line in text if line.strip()]


def same_move(a, b):
    keys = ('line', 'kind', 'x0', 'z0', 'x', 'z', 'cx', 'cz', 'feed')
    return all(a.get(key) == b.get(key) or (isinstance(a.get(key), float) and isinstance(b.get(key), float)
               and abs(a[key] - b[key]) < 1e-4) for key in keys)


def restart(board, case, line):
    """One restart; returns None if it equals the uninterrupted run, else what differs."""
    if case.reference is None:
        whole = case.record(board, 'whole')
        if whole[0].returncode or 'ended normally' not in whole[0].stdout:
            return 'uninterrupted run: ' + (whole[0].stdout + whole[0].stderr).strip()[-300:]
        # A limit switch in the last move ends the run without an alarm.
        commanded = {'X': whole[2][-1][1], 'Z': whole[2][-1][2]}
        if commanded != {axis: whole[4][axis] - HOME[A.board][axis] for axis in 'XZ'}:
            return f'uninterrupted run: ends at {whole[4]}, commanded {commanded}'
        case.reference = whole
    _, edges, positions, moves, end = case.reference
    listed = board.run_referenced([*case.words, '--restart', str(line)])
    text = listed.stdout + listed.stderr
    code = re.search(r'--confirm ([0-9a-f]+)', text)
    if not code:
        if 'collides in every order' in text:
            raise Refused
        return 'no code: ' + text.strip()[-300:]
    done, edges2, _, moves2, end2 = case.record(board, 'restart', ['--restart', str(line), '--confirm', code[1]])
    text = done.stdout + done.stderr
    if done.returncode or 'ended normally' not in done.stdout:
        return 'restart: ' + done.stdout.strip()[:400] + ' ' + done.stderr.strip()[-200:]
    approach = len(re.findall(r': Rapid to X', text))
    rest = moves2[approach:]
    problems = []
    tail = moves[len(moves) - len(rest):]
    different = [(a, b) for a, b in zip(tail, rest) if not same_move(a, b)]
    if len(rest) > len(moves) or different:
        problems.append(f'{len(rest)} moves of the rest, {len(moves)} of the whole; first different: {different[:1]}')
    begin = tail[0]['t'] if tail else positions[-1][0]
    counts = {}
    for axis in 'XZ':
        commanded = commanded_turns(positions, axis, begin)
        counts[axis] = sum(abs(turn) for turn in commanded)
        whole, again = (counted_turns(log, axis, counts[axis]) for log in (edges, edges2))
        if len(whole) != len(again) or any(abs(a - b) > 1 for a, b in zip(whole, again)):
            pairs = [(i, a, b) for i, (a, b) in enumerate(zip(whole, again)) if a != b]
            problems.append(f'{axis}: {counts[axis]} edges of the rest, reversals {len(whole)} and {len(again)}, different {pairs[:3]}')
        elif whole != again:
            print(f'  {axis}: {sum(a != b for a, b in zip(whole, again))} of {len(whole)} reversals differ by one step')
    distance = greatest_distance(path_points(edges2, counts), path_points(edges, counts))
    if distance > REACH:
        problems.append(f'path of the rest differs by {distance} steps')
    if end != end2:
        problems.append(f'end: whole {end}, restart {end2}')
    print(f'  {len(rest)} of {len(moves)} moves, edges {counts}, path within {distance} steps, end {end2}, '
          f'repeated {listed.repeated + done.repeated}')
    return '; '.join(problems) or None


def main():
    board = BenchBoard(A.bench, A.board, A.program, A.port)
    chance, failures, made, skipped, refused = random.Random(A.seed), 0, 0, [], []
    try:
        folder = pathlib.Path(board.run) / 'programs'
        cases = []
        for name, text, subprograms, macro_b in programs():
            if A.only and A.only not in name:
                continue
            if LEFT_OUT.search(re.sub(r'\([^)]*\)', '', text)):
                skipped.append(f'{name} (threads, G96, G99)')
                continue
            case = Case(folder, name, text, subprograms, macro_b)
            duration = case.simulated()
            if duration is None or duration > A.longest:
                skipped.append(f'{name} ({duration and round(duration)} s)')
                continue
            cases.append(case)
        print('left out:', ', '.join(skipped))
        print('programs:', ', '.join(case.name for case in cases), flush=True)
        while made < A.number:
            case = chance.choice(cases)
            line = chance.choice(case.lines)
            block = case.main.read_text().split('\n')[line - 1].strip()
            print(f'{time.strftime("%H:%M:%S")} {made + 1} {A.board} {case.name} line {line}: {block}', flush=True)
            try:
                why = restart(board, case, line)
            except Refused:
                refused.append(f'{case.name} line {line}')
                print('  refused: the way collides', flush=True)
                continue
            made += 1
            if why:
                failures += 1
                print(f'  DIFFERENT: {why}', flush=True)
            sys.stdout.flush()
        print(f'{made} restarts on {A.board}: {failures} different, {len(refused)} refused {refused}')
    finally:
        board.end()
    sys.exit(1 if failures else 0)


if __name__ == '__main__':
    main()
