"""What the answers of a challenge state, against how many are right.

    python3 docs/challenge_stated.py challenge/challenge.json

Of effects that have one name as their answer: those on the errors are scored by
the noises, two others by their group, and four are in no catalogue. Whether what is
stated is right shows where answers are sorted by what they say: of the effects
alone, those that a recording hardly shows are answered by nothing, which half of
the prior is for.
"""

import json
import pathlib
import sys

NOTHING = "none"
OTHERWISE = {
    "ar1", "heavy-tails", "unequal-variance", "slope-bias", "averaging-window",
    "cubic-drag", "periodic-force", "late-friction", "wall-drag",
}
VISIBLE = 8  # ln: what shows an effect at all


def said(name, answers):
    if not answers:
        print(f"{name}: none")
        return
    right = sum(a["answer"] == a["truth"] for a in answers) / len(answers)
    stated = sum(a["probability"] for a in answers) / len(answers)
    print(f"{name}: {right:.2f} of {len(answers)} right, {stated:.2f} stated")


def main():
    scored = json.loads(pathlib.Path(sys.argv[1]).read_text())
    answers = [a for a in scored["answers"] if a["truth"] not in OTHERWISE]
    hidden = [a for a in answers if a["truth"] != NOTHING]
    said("effects", hidden)
    said("effects that gain 8", [a for a in hidden if a["gain"] >= VISIBLE])
    said("answers that nothing is missing",
         [a for a in answers if a["answer"] == NOTHING])
    said("answers that name an effect",
         [a for a in answers if a["answer"] != NOTHING])


if __name__ == "__main__":
    main()
