#!/usr/bin/env python3
"""The NC-B08 and the Huaxing 31 on real Grbl firmware: counted step edges in four scenes.

program: `run --model M --link --home` to the end; the distances between the reversals of each
    axis equal those of `--positions` (one step), and the slides end where they began.
hold: `operate` with feed hold and cycle start in motion; the slides stand in the hold, and the
    reversals and the end equal those of the uninterrupted run.
reset: [RESET] in motion; the counts of `link.log` agree, and equal the counted edges.
limit: a limit switch operated in motion; the slides stop, and the coordinates in the text of
    alarm 622 equal the counted edges.
clear: the same; [RESET] and the open switch clear the alarm, and the slides stay.

Needs a folder with the images and configurations of the firmware bench (`firmware_bench.py`).

usage: board_siblings.py PROGRAM BENCH [--model ncb08|hx31] [--scene NAME]
"""
import argparse, os, pathlib, re, shutil, subprocess, sys, time
from firmware_bench import HOME, PULSES, BenchBoard, commanded_turns, counted_turns, read_edges, read_positions

P = argparse.ArgumentParser()
P.add_argument('program')
P.add_argument('bench')
P.add_argument('--port', type=int, default=9501)
P.add_argument('--model', choices=['ncb08', 'hx31'])
P.add_argument('--scene', choices=['program', 'hold', 'reset', 'limit', 'clear'])
A = P.parse_args()
# The programs of the test with the virtual boards.
PROGRAMS = {
    'ncb08': 'O21\nG50 X60 Z20\nG98 S500 M03\nG00 X40 Z5 M08\nM10 P0\nG01 Z-10 F300\nG02 X50 Z-15 R-5.2\n'
             'G01 X52\nG04 X0.2\nM11 P0\nG00 X60 Z20\nM05\nM2\n',
    'hx31': '%P22\nN10 G92 X60 Z20\nN20 G98 S500 M03\nN30 G90 G00 X40 Z5\nN40 G01 Z-10 F300\nN50 G91 G01 X2 Z-1\n'
            'N60 X-1\nN70 G26 N50.60.2\nN80 G90 G02 X53 Z-18 I10 K0\nN90 G00 X60 Z20\nN95 M05\nN99 M02\n',
}
# Rapids that the board can make with the gear of the bench.
OPTIONS = ['--param', '22=3800', '--param', '23=7600']
REFERENCE = ('press RESET\nwait 1500ms\npress ZRN\npress XP\nwait 4s\npress ZP\nwait 5s\nexpect referenced X\n'
             'expect referenced Z\nexpect alarm none\nload {program}\npress AUTO\npress CS\n')
SCRIPTS = {
    'hold': 'wait 2500ms\npress FH\nwait 2s\npress CS\nwait idle 60s\nwait 500ms\nexpect alarm none\n',
    'reset': 'wait 2500ms\npress RESET\nwait 2s\nexpect alarm none\n',
    # The text of an alarm is printed by an expectation that is not met.
    'limit': 'wait 8s\nexpect alarm 622\nexpect alarm none\n',
    'clear': 'wait 8s\nexpect alarm 622\nwait 6s\npress RESET\nwait 4s\npress RESET\nwait 4s\nexpect alarm none\n',
}
LINK_LOG = re.compile(r'commanded X (-?\d+) Z (-?\d+) counted X (-?\d+) Z (-?\d+) (.*)')


class Scenes:
    def __init__(self, model, board):
        self.model, self.board = model, board
        self.folder = pathlib.Path(board.run) / model
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.program = self.folder / 'program.CNC'
        self.program.write_text(PROGRAMS[model])
        self.options = ['--model', model, *OPTIONS]
        board.write_settings(self.options)
        self.plain = None

    def program_run(self):
        steps, csv = self.folder / 'program.log', self.folder / 'program.csv'
        done = self.board.run_referenced([str(self.program), *self.options, '--positions', str(csv)], steps)
        end, positions, edges = self.board.stat(), read_positions(csv), read_edges(steps)
        problems = [] if 'ended normally' in done.stdout else [(done.stdout + done.stderr).strip()[-400:]]
        self.plain = {'end': end}
        for axis in 'XZ':
            commanded = commanded_turns(positions, axis)
            counted = counted_turns(edges, axis, sum(map(abs, commanded)))
            self.plain[axis] = counted
            if len(commanded) != len(counted) or any(abs(a - b) > 1 for a, b in zip(commanded, counted)):
                problems.append(f'{axis}: commanded {commanded}, counted {counted}')
            print(f'  {axis}: {sum(map(abs, counted))} edges counted, {sum(map(abs, commanded))} commanded, '
                  f'reversals {counted}')
        print(f'  end {end}')
        return problems

    def operate(self, scene, action=None):
        """A script of keys on the board; returns the finished process, edges, end and link log."""
        script, steps = self.folder / f'{scene}.txt', self.folder / f'{scene}.log'
        data = self.folder / f'data-{scene}'
        script.write_text(REFERENCE.format(program=self.program) + SCRIPTS[scene])
        for _ in range(5):
            shutil.rmtree(data, ignore_errors=True)
            self.board.word('auto B4')
            self.board.place_before_switches()
            self.board.word(f'steps {steps}')
            before = self.board.lost_ms()
            command = [A.program, 'operate', str(script), *self.options, '--data', str(data), '--param', '11.2=1',
                       '--param', '17=5', '--param', '18=5', '--lang', 'en', '--link', self.board.port,
                       '--machine', self.board.machine]
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                       stderr=subprocess.STDOUT, text=True)
            if action:
                action(process)
            output = process.communicate(timeout=200)[0]
            if not self.board.is_bench_fault(output, before):
                break
        end = self.board.stat()
        self.board.word('steps off')
        time.sleep(0.2)
        log = (data / 'link.log').read_text() if (data / 'link.log').exists() else ''
        return process.returncode, output, read_edges(steps), end, log

    def home(self):
        """Pulses of the machine zero on the bench."""
        return HOME['grbl']

    def check_count(self, log, end):
        """The last line of the link log against the counted edges."""
        lines = LINK_LOG.findall(log)
        if not lines:
            return ['no line in link.log']
        counted = {'X': int(lines[-1][2]), 'Z': int(lines[-1][3])}
        on_bench = {axis: end[axis] - self.home()[axis] for axis in 'XZ'}
        print(f'  link.log: {lines[-1]}; counted edges from the machine zero {on_bench}')
        return [] if counted == on_bench else [f'the control counts {counted}, the bench {on_bench}']

    def hold(self):
        if self.plain is None:
            self.program_run()
        code, output, edges, end, log = self.operate('hold')
        problems = [] if code == 0 else [output.strip()[-400:]]
        for axis in 'XZ':
            plain = self.plain[axis]
            counted = counted_turns(edges, axis, sum(map(abs, plain)))
            if counted != plain:
                problems.append(f'{axis}: reversals {counted}, uninterrupted {plain}')
        if end != self.plain['end']:
            problems.append(f'end {end}, uninterrupted {self.plain["end"]}')
        held = LINK_LOG.findall(log)
        print(f'  {len(held)} standstills compared, all agree: {all(row[4].startswith("agrees") for row in held)}; end {end}')
        if not all(row[4].startswith('agrees') for row in held):
            problems.append(log)
        return problems + self.check_count(log, end)

    def reset(self):
        code, output, _, end, log = self.operate('reset')
        problems = [] if code == 0 else [output.strip()[-400:]]
        if end == {axis: at for axis, at in self.home().items()}:
            problems.append('not in motion')
        rows = LINK_LOG.findall(log)
        if not rows or not rows[-1][4].startswith('agrees'):
            problems.append(log)
        return problems + self.check_count(log, end)

    def trip(self, scene):
        """Operates the switch of Z while Z moves in the program, and releases it later."""
        seen, home = {}, self.home()['Z']

        def press(process):
            reached = False
            while process.poll() is None:
                at = self.board.stat()['Z']
                reached = reached or at == home
                if reached and at < home - 4000:
                    self.board.word('pin B4 0')
                    time.sleep(1)
                    seen['stopped'] = self.board.stat()
                    time.sleep(2)
                    seen['later'] = self.board.stat()
                    time.sleep(6)
                    self.board.word('auto B4')
                    return
                time.sleep(0.02)

        code, output, _, end, _ = self.operate(scene, press)
        print(f'  {seen}, end {end}')
        stands = seen and seen['stopped'] == seen['later'] == end
        return code, output, end, [] if stands else ['the slides do not stand after the switch']

    def limit(self):
        _, output, end, problems = self.trip('limit')
        shown = re.search(r'alarms: E?622: .*machine coordinates X (\S+) Z (\S+) by the board\'s count.*', output)
        on_bench = {axis: end[axis] - self.home()[axis] for axis in 'XZ'}
        if not shown:
            return problems + [output.strip()[-400:]]
        counted = {'X': round(float(shown[1]) * PULSES['X']), 'Z': round(float(shown[2]) * PULSES['Z'])}
        print(f'  {shown[0]}; counted edges from the machine zero {on_bench}')
        return problems + ([] if counted == on_bench else [f'the control shows {counted}, the bench {on_bench}'])

    def clear(self):
        code, output, _, problems = self.trip('clear')
        return problems + ([] if code == 0 else [output.strip()[-600:]])


def main():
    board, failures = BenchBoard(A.bench, 'grbl', A.program, A.port), 0
    try:
        for model in [A.model] if A.model else PROGRAMS:
            scenes = Scenes(model, board)
            for name in [A.scene] if A.scene else ['program', 'hold', 'reset', 'limit', 'clear']:
                print(f'{time.strftime("%H:%M:%S")} {model} {name}', flush=True)
                problems = scenes.program_run() if name == 'program' else getattr(scenes, name)()
                failures += bool(problems)
                print('  equal' if not problems else '  DIFFERENT: ' + '; '.join(problems), flush=True)
    finally:
        board.end()
    print(f'{failures} scenes different')
    sys.exit(1 if failures else 0)


if __name__ == '__main__':
    main()
