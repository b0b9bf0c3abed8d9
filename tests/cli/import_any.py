"""import_any.py: writes recordings in dresses that testers give them, by chance, each with the numbers that it must become.

    import_any.py DIR COUNT SEED    DIR/NNN.* and DIR/NNN.truth (time_s,depth_mm,force_N in the order of the rows kept)
    import_any.py --compare DIR OUT compares OUT/NNN.csv with the truth; exit 1 with what differs
"""
import os
import random
import sys

NAMES = {  # time, depth, force, stress, strain; height, diameter
    "en": (["Time", "Elapsed Time", "Test time", "t"], ["Displacement", "Compression", "Crosshead position", "Travel", "Stroke", "Extension"],
           ["Force", "Load", "Axial force", "Load cell"], ["Stress", "Compressive stress"], ["Strain", "Compressive strain"],
           ["Height", "Specimen length", "Initial height"], ["Diameter", "Specimen diameter"]),
    "de": (["Zeit", "Prüfzeit", "Versuchszeit"], ["Weg", "Standardweg", "Traversenweg", "Verschiebung", "Verformung"],
           ["Kraft", "Standardkraft", "Prüfkraft"], ["Spannung", "Druckspannung"], ["Dehnung", "Stauchung"],
           ["Höhe", "Probenhöhe", "Anfangshöhe h0", "Probenlänge"], ["Durchmesser", "Probendurchmesser"]),
    "fr": (["Temps", "Temps d'essai"], ["Déplacement", "Course", "Enfoncement", "Déplacement traverse"], ["Force", "Charge", "Effort"],
           ["Contrainte"], ["Déformation"], ["Hauteur", "Longueur initiale", "Hauteur de l'éprouvette"], ["Diamètre"]),
    "it": (["Tempo", "Tempo di prova"], ["Spostamento", "Corsa", "Corsa traversa"], ["Forza", "Carico"], ["Sforzo", "Tensione"],
           ["Deformazione"], ["Altezza", "Lunghezza iniziale"], ["Diametro"]),
    "es": (["Tiempo", "Tiempo de ensayo"], ["Desplazamiento", "Carrera", "Posición"], ["Fuerza", "Carga"], ["Esfuerzo", "Tensión"],
           ["Deformación"], ["Altura", "Longitud inicial"], ["Diámetro"]),
    "pt": (["Tempo", "Tempo de ensaio"], ["Deslocamento", "Curso", "Posição"], ["Força", "Carga"], ["Tensão"], ["Deformação"],
           ["Altura", "Comprimento inicial"], ["Diâmetro"]),
}
TIMES = [("s", 1), ("ms", 1e3), ("min", 1 / 60)]
DEPTHS = [("mm", 1), ("um", 1e3), ("µm", 1e3), ("cm", 0.1), ("m", 1e-3)]
FORCES = [("N", 1), ("mN", 1e3), ("kN", 1e-3), ("gf", 1 / 9.80665e-3), ("kgf", 1 / 9.80665), ("lbf", 1 / 4.4482216152605)]
STRESSES = [("Pa", 1), ("kPa", 1e-3), ("MPa", 1e-6), ("N/mm²", 1e-6)]
STRAINS = [("%", 100), ("mm/mm", 1), ("-", 1)]
PI = 3.14159265358979323846


def press(dice):
    """One press: a rest, a ramp, a dwell, perhaps back. Times, depths, forces."""
    rate, deepest, height = dice.choice([0.01, 0.2, 3.0]), dice.uniform(0.5, 6), 24.0
    step = deepest / rate / dice.randint(40, 90)
    ramp, rest, dwell = deepest / rate, dice.randint(6, 15) * step, dice.choice([0.3, 2.0]) * deepest / rate
    back = dice.random() < 0.3
    stiffness = 10 ** dice.uniform(-3, 3)
    rows, k = [], 0
    while k * step <= rest + ramp + dwell + (ramp if back else 0):
        t = k * step
        x = t - rest
        depth = 0 if x < 0 else rate * x if x < ramp else deepest if x < ramp + dwell else deepest - rate * (x - ramp - dwell)
        depth = max(depth, 0.0)
        force = stiffness * (depth + 0.1 * depth * depth) * (1 if x < ramp else 0.7 + 0.3 * 2.718 ** (-(x - ramp) / ramp))
        rows.append((t, depth, force))
        k += 1
    return rows, height, deepest, stiffness


class Dress:
    def __init__(self, dice):
        self.dice = dice
        self.separator = dice.choice([";", "\t", ",", " ", ";", "\t"])
        self.decimal = "." if self.separator == "," else dice.choice([".", ","])
        self.group = dice.choice(["", "", "," if self.decimal == "." else "."]) if self.separator not in ", " else ""
        self.encoding = dice.choice(["utf-8", "utf-8-sig", "latin-1", "utf-16", "utf-16-le"])
        self.end = dice.choice(["\n", "\r\n"])
        self.quotes = self.separator != " " and dice.random() < 0.2
        self.language = dice.choice(sorted(NAMES))

    def number(self, x, digits, scientific=False):
        text = "%.*e" % (digits, x) if scientific else "%.*f" % (digits, x)
        if "e" in text:
            text = text.replace(".", self.decimal)
        else:
            whole, _, fraction = text.partition(".")
            sign = "-" if whole.startswith("-") else ""
            whole = whole.lstrip("-")
            if self.group:
                groups = []
                while len(whole) > 3:
                    groups.insert(0, whole[-3:])
                    whole = whole[:-3]
                whole = self.group.join([whole] + groups)
            text = sign + whole + (self.decimal + fraction if fraction else "")
        return '"%s"' % text if self.quotes else text

    def join(self, fields):
        return self.separator.join(fields)


def value_of(text, dress):
    """The number as the file tells it."""
    text = text.strip('"')
    if dress.group:
        text = text.replace(dress.group, "")
    return float(text.replace(",", "."))


def header_lines(dress, dice, height, diameter):
    """Lines about the specimen, as setting or table."""
    names = NAMES[dress.language]
    h, d = dice.choice(names[5]), dice.choice(names[6])
    unit = dice.choice([("mm", 1), ("cm", 0.1), ("mm", 1)])
    def size(x):
        return ("%.3f" % (x * unit[1])).replace(".", dress.decimal)
    style = dice.randrange(4)
    if style == 0 and dress.separator != " ":
        return [dress.join([h, size(height), unit[0]]), dress.join([d, size(diameter), unit[0]])]
    if style == 1:
        return ["%s: %s %s" % (h, size(height), unit[0]), "%s: %s %s" % (d, size(diameter), unit[0])]
    if style == 2 and dress.separator not in " ,":
        return [dress.join(["Results", h, d]), dress.join(["", "(%s)" % unit[0]] + ["(%s)" % unit[0]]),
                dress.join(["1", size(height), size(diameter)]), ""]
    return ["%s (%s) = %s" % (h, unit[0], size(height)), "%s (%s) = %s" % (d, unit[0], size(diameter))]


def columns(dress, dice, rows, height, area_m2):
    """The columns in the order of the file: name, unit, texts; and the truth of each row."""
    names = NAMES[dress.language]
    ut, ud, uf = dice.choice(TIMES), dice.choice(DEPTHS), dice.choice(FORCES)
    depth_sign, force_sign = dice.choice([1, -1]), dice.choice([1, -1])
    scientific = dice.random() < 0.2
    strain, stress = dice.random() < 0.15, dice.random() < 0.15
    clock = dice.random() < 0.12
    made = {}
    truth = [[0, 0, 0] for _ in rows]
    def column(k, name, unit, factor, back, sign, offset=0.0):
        peak = max(abs(r[k] * factor) for r in rows) or 1
        digits = 6 if scientific else max(0, 6 - len("%d" % peak)) if peak >= 1 else 6 + len(("%.0e" % peak).split("-")[-1].lstrip("0")) + int(("%.0e" % peak).split("e")[1]) * -1
        texts = [dress.number(sign * r[k] * factor + offset, min(digits, 16), scientific) for r in rows]
        for i, text in enumerate(texts):
            truth[i][k] = sign * (value_of(text, dress) - offset) * back
        made[k] = (name, unit, texts)
    if clock:
        start = dice.randrange(80000)
        texts = []
        for i, r in enumerate(rows):
            t = start + r[0]
            texts.append("%02d:%02d:%06.3f" % (t // 3600 % 24, t // 60 % 60, t % 60))
            texts[-1] = texts[-1].replace(".", dress.decimal)
            truth[i][0] = round(t % 60, 3) + 60 * (t // 60) - start
        made[0] = (dice.choice(names[0]), "", texts)
    else:
        column(0, dice.choice(names[0]), ut[0], ut[1], 1 / ut[1], 1)
    if strain:
        u = dice.choice(STRAINS)
        column(1, dice.choice(names[4]), u[0], u[1] / height, height / u[1], depth_sign)
    else:
        column(1, dice.choice(names[1]), ud[0], ud[1], 1 / ud[1], depth_sign)
    if stress:
        u = dice.choice(STRESSES)
        column(2, dice.choice(names[3]), u[0], u[1] / area_m2, area_m2 / u[1], force_sign)
    else:
        column(2, dice.choice(names[2]), uf[0], uf[1], 1 / uf[1], force_sign)
    order = [made[0], made[1], made[2]]
    dice.shuffle(order)
    if dice.random() < 0.3:
        order.insert(dice.randrange(4), ("Temperature", "°C", [dress.number(25 + 0.01 * i, 2) for i in range(len(rows))]))
    if dice.random() < 0.2:
        order.insert(dice.randrange(1, 4), ("Status", "", ["ok"] * len(rows)))
    if dice.random() < 0.2 and not strain:
        order.append(("Extensometer 1 position" if dress.language == "en" else made[1][0] + " 2", made[1][1], made[1][2]))
    return order, truth


def write(path, dice):
    dress = Dress(dice)
    rows, height, _, _ = press(dice)
    diameter = 2 * dice.uniform(3, 15)
    diameter = round(diameter, 1)
    area_m2 = PI * (diameter / 2) ** 2 * 1e-6
    order, truth = columns(dress, dice, rows, height, area_m2)
    lines = [dice.choice(["", "Test report", "Lab 7; gel", "# exported"])] if dress.separator != ";" else ["Report"]
    lines += header_lines(dress, dice, height, diameter)
    if dice.random() < 0.3:
        lines.append("")
    if any(unit == "" and name != "Status" for name, unit, _ in order):
        style = "brackets"
    else:
        style = dice.choice(["brackets", "square", "row", "bracket row", "suffix"])
    word = (lambda text: text.replace(" ", "_")) if dress.separator == " " else (lambda text: text)
    if style in ("brackets", "square", "suffix"):
        form = {"brackets": "%s (%s)", "square": "%s [%s]", "suffix": "%s, %s" if dress.separator not in ", " else "%s_%s"}[style]
        lines.append(dress.join([word(name) if not unit else form % (word(name), unit) for name, unit, _ in order]))
    else:
        lines.append(dress.join([word(name) for name, _, _ in order]))
        form = "(%s)" if style == "bracket row" else "%s"
        lines.append(dress.join([form % (unit or "-") for _, unit, _ in order]))
    kept = []
    faults = dice.random() < 0.25
    for i in range(len(rows)):
        fields = [texts[i] for _, _, texts in order]
        if faults and i == len(rows) // 2:
            lines.append(dress.join(["---" if "ok" != f else f for f in fields]) if dice.random() < 0.5 else "overload")
            continue
        lines.append(dress.join(fields))
        kept.append(truth[i])
        if faults and i == len(rows) // 3:
            lines.append(lines[-1])
    suffix = dice.choice([".csv", ".txt", ".TRA", ".dat"])
    with open(path + suffix, "wb") as out:
        out.write((dress.end.join(lines) + dress.end).encode(dress.encoding, "replace"))
    with open(path + ".truth", "w") as out:
        for row in kept:
            out.write("%.17g,%.17g,%.17g\n" % tuple(row))


def compare(folder, out):
    bad = 0
    for name in sorted(f for f in os.listdir(folder) if f.endswith(".truth")):
        path = os.path.join(out, name[:-6] + ".csv")
        if not os.path.exists(path):
            print(name, "was not imported")
            bad += 1
            continue
        with open(os.path.join(folder, name)) as f:
            want = [[float(x) for x in line.split(",")] for line in f]
        with open(path) as f:
            got = [[float(x) for x in line.split(",")[:3]] for line in f if line[0] in "-0123456789"]
        if len(want) != len(got):
            print(name, len(got), "rows, not", len(want))
            bad += 1
            continue
        for k in range(3):
            size = max(abs(row[k]) for row in want)
            sign = 1 if k == 0 else 1 if sum(row[k] for row in want) > 0 else -1
            worst = max(abs(a[k] - sign * b[k]) for a, b in zip(got, want))
            if worst > 2e-6 * size:
                print(name, ("time", "depth", "force")[k], "differs by", worst, "of", size)
                bad += 1
                break
    return bad


if __name__ == "__main__":
    if sys.argv[1] == "--compare":
        sys.exit(1 if compare(sys.argv[2], sys.argv[3]) else 0)
    os.makedirs(sys.argv[1], exist_ok=True)
    for number in range(int(sys.argv[2])):
        write(os.path.join(sys.argv[1], "%03d" % number), random.Random(int(sys.argv[3]) * 100000 + number))
