#!/bin/sh
# pictures.sh: what the README says of a picture is what the picture shows. tools/pictures.sh writes doc/pictures/NAME.json
# beside a picture with figures. Its version is this one, its sum that of the picture, and each number of the README's
# caption, the paragraph in italics below the picture, is one of its figures as far as it is printed.
set -eu
cd "$(dirname "$0")/../.."
version=$(sed -n 's/^.define PALP_VERSION "\(.*\)"/\1/p' include/palpate/version.h)
python3 - "$version" "${1-README.md}" doc/pictures <<'END'
import glob, hashlib, json, os, re, sys
version, page, folder = sys.argv[1:]
text = open(page).read()
wrong = []

def numbers(value):
    if isinstance(value, dict):
        return [n for v in value.values() for n in numbers(v)]
    if isinstance(value, list):
        return [n for v in value for n in numbers(v)]
    return [value] if isinstance(value, (int, float)) else []

def printed_alike(word, value):
    decimals = len(word.partition('.')[2])
    return abs(float(word) - value) <= 0.5 * 10 ** -decimals * (1 + 1e-9)

names = sorted(os.path.splitext(os.path.basename(f))[0] for f in glob.glob(folder + '/*.json'))
if names != ['explain', 'press']:
    wrong.append('%s: figures of %s, not of explain and press; run make pictures' % (folder, names))
for name in names:
    kept = json.load(open('%s/%s.json' % (folder, name)))
    picture = open('%s/%s.png' % (folder, name), 'rb').read()
    if kept['version'] != version:
        wrong.append('%s.png is of version %s; run make pictures' % (name, kept['version']))
    if kept['picture_sha256'] != hashlib.sha256(picture).hexdigest():
        wrong.append('%s.json is not of this %s.png; run make pictures' % (name, name))
    caption = re.search(r'\]\(doc/pictures/%s\.png\)\s*\n\n\*((?:[^*]|\n)+)\*' % name, text)
    words = re.findall(r'(?<![\w.])-?\d+(?:\.\d+)?(?![\w%])', re.sub(r'`[^`]*`', '', caption.group(1))) if caption else []
    if not words:
        wrong.append('%s: no figure in the caption below %s.png' % (page, name))
    for word in words:
        if not any(printed_alike(word, value) for value in numbers(kept['figures'])):
            wrong.append('%s: %s in the caption below %s.png is none of %s' % (page, word, name, numbers(kept['figures'])))
    for effect in kept['figures'].get('effects', []):
        if caption and effect['id'].split('_')[-1] not in caption.group(1):
            wrong.append('%s: the caption below %s.png does not name %s' % (page, name, effect['id']))
    if kept['figures'].get('tick_ms', 0) >= 1:
        wrong.append('%s.png shows a tick of %s ms below a promise of 1 kHz' % (name, kept['figures']['tick_ms']))
print('\n'.join(wrong))
sys.exit(bool(wrong))
END
