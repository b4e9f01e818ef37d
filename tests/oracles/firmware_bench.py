"""A board of the firmware bench, used by `board_restarts.py` and `board_siblings.py`.

The bench is a folder with `bench/grbl.conf`, `bench/klipper.conf` and the built images: a
simulated AVR that runs unmodified Grbl or Klipper firmware, answers on a TCP port, counts every
step edge and writes it to a log."""
import csv, os, re, subprocess, time

# Pulses per mm of the positions file (X is a diameter) with the gear 1/5 of both axes.
PULSES = {'X': 200.0, 'Z': 200.0}
GEAR = ['--param', '17=5', '--param', '18=5']
# Alarms of a computer that is too busy for board and control.
BUSY = re.compile(r'(?<!\d)(601|605|612)(?!\d)')
# Alarms after which a run is repeated if the simulated board has lost time. It does when its
# computer is busy; a real one does not. 606 and 610 follow in the run after such a fault.
LOST_TIME = re.compile(r'(?<!\d)(606|608|610|611)(?!\d)|the link failed')
# Just before the switches, so that a reference return is short.
BEFORE_SWITCHES = {'grbl': {'X': 3800, 'Y': 3800, 'Z': 7800}, 'klipper': {'X': 1100, 'Z': 2300}}
# Counts of the bench at the machine zero.
HOME = {'grbl': {'X': 3600, 'Z': 7800}, 'klipper': {'X': 3200, 'Z': 6400}}


class BenchBoard:
    """A simulated board: starts it, ends it, reads its counts."""

    def __init__(self, bench, kind, program, port):
        self.bench, self.kind, self.program = os.path.abspath(bench), kind, program
        self.run = os.path.join(self.bench, 'run', f'oracle-{kind}-{port}')
        os.makedirs(self.run, exist_ok=True)
        self.port = f'tcp:127.0.0.1:{port}'
        self.log = os.path.join(self.run, 'bench.log')
        with open(os.path.join(self.bench, 'bench', f'{kind}.conf')) as source:
            text = source.read()
        text = re.sub(r'^(link|ctl) .*/(\w+)$', lambda m: f'{m[1]} {self.run}/{m[2]}', text, flags=re.M)
        text = re.sub(r'^elf (.*)$', lambda m: f'elf {self.bench}/{m[1]}', text, flags=re.M)
        conf = os.path.join(self.run, 'board.conf')
        with open(conf, 'w') as out:
            out.write(f'{text}\ntcp {port}\n')
        self.machine = os.path.join(self.run, 'machine.ron')
        firmware = ['--firmware', 'klipper'] if kind == 'klipper' else []
        with open(self.machine, 'w') as out:
            subprocess.run([program, 'link', 'twin', *firmware, '--print-machine'], check=True, stdout=out)
        self.process = subprocess.Popen([os.path.join(self.bench, 'images', 'avrtcp'), conf],
                                        stdout=open(self.log, 'w'), stderr=subprocess.STDOUT)
        time.sleep(1)
        if self.process.poll() is not None:
            raise SystemExit(f'the board does not start: {self.log}')
        # The image of Grbl begins with an empty EEPROM.
        if kind == 'grbl':
            self.write_settings([])

    def write_settings(self, options):
        """Writes the settings that the parameters need, as `link test` does."""
        for _ in range(4):
            done = self.call(['link', 'test', self.port, '--machine', self.machine, '--write-settings',
                              *GEAR, *options], linked=False)
            if done.returncode == 0:
                return
        raise SystemExit('the settings are not written: ' + done.stdout + done.stderr)

    def call(self, words, linked=True, timeout=420):
        """Runs the program; `linked` adds the options of the board."""
        command = [self.program, *words, '--lang', 'en']
        if linked:
            command += ['--link', self.port, '--machine', self.machine, *GEAR]
        return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=timeout)

    def run_referenced(self, words, steps=None, attempts=8):
        """`run` after a short reference return. A busy computer lets the board answer late (601, 605, 612),
        or the simulated board loses time (608, 611). Then the run is repeated; `repeated` of the
        result counts that."""
        for attempt in range(attempts):
            self.place_before_switches()
            self.word(f'steps {steps or "off"}')
            before = self.lost_ms()
            done = self.call(['run', *words, '--home'])
            text = done.stdout + done.stderr
            if done.returncode == 0 or not self.is_bench_fault(text, before):
                break
            print(f'  repeated, the board lost {self.lost_ms() - before} ms: {" ".join(text.split())[:160]}', flush=True)
            time.sleep(2)
        self.stat()
        self.word('steps off')
        time.sleep(0.2)
        done.repeated = attempt
        return done

    def is_bench_fault(self, text, before):
        """Whether a busy computer has ended a run. `before`: the time the board had lost when it began."""
        return bool(BUSY.search(text)) or self.lost_ms() > before + 20 and bool(LOST_TIME.search(text))

    def lost_ms(self):
        """Time that the simulated board has lost since it was started, ms."""
        self.stat()
        return self.lost

    def place_before_switches(self):
        for axis, position in BEFORE_SWITCHES[self.kind].items():
            self.word(f'place {axis} {position}')
        time.sleep(0.1)

    def word(self, word):
        """Writes a word into the control file of the bench."""
        with open(os.path.join(self.run, 'ctl'), 'w') as out:
            out.write(word + '\n')
        time.sleep(0.02)

    def stat(self):
        """Positions by the counted edges, in pulses."""
        before = os.path.getsize(self.log)
        self.word('stat')
        for _ in range(500):
            time.sleep(0.01)
            with open(self.log, errors='replace') as log:
                log.seek(before)
                found = re.search(r'STAT (.*)\n', log.read())
            if found:
                self.lost = int(re.search(r'lags \d+ \((\d+) ms\)', found[1])[1])
                return {axis: int(at) for axis, at in re.findall(r'\b([XZ]) pos (-?\d+)', found[1])}
        raise SystemExit('the bench does not answer')

    def end(self):
        self.process.terminate()
        self.process.wait()


def read_edges(path):
    """The counted edges: a list of (axis, position after the edge) in their order."""
    edges = []
    with open(path) as log:
        for line in log:
            words = line.split()
            if len(words) == 3 and words[0] in 'XZ':
                edges.append((words[0], int(words[2])))
    return edges


def read_positions(path):
    """Commanded time, X and Z in pulses from the positions file."""
    with open(path) as text:
        rows = csv.reader(text)
        next(rows)
        return [(float(row[0]), round(float(row[1]) * PULSES['X']), round(float(row[2]) * PULSES['Z']))
                for row in rows]


def turns(positions):
    """Distances between reversals, in pulses."""
    out, sum_, last = [], 0, None
    for position in positions:
        if last is not None and position != last:
            if sum_ and (position > last) != (sum_ > 0):
                out.append(sum_)
                sum_ = 0
            sum_ += position - last
        last = position
    return out + [sum_] if sum_ else out


def commanded_turns(positions, axis, begin_s=0.0):
    column = 1 if axis == 'X' else 2
    return turns([row[column] for row in positions if row[0] >= begin_s])


def counted_turns(edges, axis, number):
    """The distances between reversals in the last `number` edges of an axis."""
    at = [position for name, position in edges if name == axis]
    tail = at[-number:] if number else []
    if not tail:
        return []
    before = at[-number - 1] if len(at) > number else tail[0] - 1
    return turns([before, *tail])


def path_points(edges, counts):
    """The path of the last edges of both axes: (X, Z) after each edge. `counts`: edges of an axis."""
    skip = {axis: sum(name == axis for name, _ in edges) - counts[axis] for axis in 'XZ'}
    at, points = {}, []
    for axis, position in edges:
        at[axis] = position
        if skip[axis] > 0:
            skip[axis] -= 1
        elif len(at) == 2:
            points.append((at['X'], at['Z']))
    return points


def greatest_distance(points, reference, reach=40):
    """Greatest distance of a path from another with the same edges, in steps (Chebyshev). A point
    is compared with the points of the same number of edges, more or less `reach`."""
    if len(points) != len(reference):
        return float('inf')
    worst = 0
    for index, (x, z) in enumerate(points):
        if reference[index] == (x, z):
            continue
        near = reference[max(0, index - reach):index + reach + 1]
        worst = max(worst, min(max(abs(at_x - x), abs(at_z - z)) for at_x, at_z in near))
    return worst
