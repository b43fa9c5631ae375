"""Judge a scene: measure its path, compare with the scene's own thresholds, tell the result."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rich.text import Text

from limbik.core.bodyscene import BodyScene
from limbik.core.errors import Fault, SceneError
from limbik.core.registry import Registry
from limbik.core.scene import Scene
from limbik.core.wording import near_match
from limbik.plugins.judging.catalogue import BY_NAME, METRICS, Metric
from limbik.plugins.judging.run import NotJudged, run_scene
from limbik.plugins.output.table import new_console, new_table

PASSED, FAILED, MEASURED, NOT_JUDGED = "passed", "failed", "measured", "not judged"


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of one metric.

    Attributes:
        metric: The metric.
        value: Its value; None where it says nothing about this scene.
        most: The scene's threshold; None where it has none.
        reason: Why there is no value.
    """

    metric: Metric
    value: float | None
    most: float | None
    reason: str = ""

    @property
    def word(self) -> str:
        """`passed`, `failed`, `measured` or `not judged`; a threshold without a value fails."""
        if self.most is not None:
            return PASSED if self.value is not None and self.value <= self.most else FAILED
        return NOT_JUDGED if self.value is None else MEASURED


def judge(
    scene: Scene, registry: Registry | None = None, *, only_thresholds: bool = False
) -> list[Verdict]:
    """Solve a scene's path and measure it.

    Args:
        scene: The scene.
        registry: Where the strategies are looked up; a new one if absent.
        only_thresholds: Measure nothing but what the scene has thresholds for.

    Raises:
        SceneError: The scene's `judge` section names a metric that does not exist.
    """
    most = {} if scene.judge is None else scene.judge.max
    unknown = [name for name in most if name not in BY_NAME]
    if unknown:
        raise SceneError([_unknown(name, scene) for name in unknown])
    run = run_scene(scene, registry)
    verdicts = []
    for metric in METRICS:
        if only_thresholds and metric.name not in most:
            continue
        try:
            verdicts.append(Verdict(metric, metric.measure(run), most.get(metric.name)))
        except NotJudged as why:
            verdicts.append(Verdict(metric, None, most.get(metric.name), str(why)))
    return verdicts


def _unknown(name: str, scene: Scene) -> Fault:
    hint = near_match(name, list(BY_NAME)) or f"known: {', '.join(BY_NAME)}"
    message = f"no metric is called '{name}'"
    path = ("judge", "max", name)
    return scene.document.fault("unknown-metric", message, path, hint=hint, at_key=True)


def are_passed(verdicts: list[Verdict]) -> bool:
    """Whether no threshold is exceeded."""
    return all(verdict.word != FAILED for verdict in verdicts)


def judge_record(scene: Scene, verdicts: list[Verdict]) -> dict[str, Any]:
    """Describe the verdicts for machines."""
    return {
        "status": "ok" if are_passed(verdicts) else "failed",
        "scene": scene.document.name,
        "metrics": [
            {
                "name": verdict.metric.name,
                "number": verdict.metric.number,
                "value": verdict.value,
                "unit": verdict.metric.unit,
                "max": verdict.most,
                "verdict": verdict.word,
                "reason": verdict.reason,
            }
            for verdict in verdicts
        ],
    }


def body_record(scene: BodyScene, verdicts: Mapping[str, list[Verdict]]) -> dict[str, Any]:
    """Describe the verdicts on each chain for machines."""
    chains = []
    for part in scene.parts:
        record = judge_record(part.scene, verdicts[part.name])
        chains.append({"name": part.name, "metrics": record["metrics"]})
    passed = all(map(are_passed, verdicts.values()))
    status = "ok" if passed else "failed"
    return {"status": status, "scene": scene.document.name, "chains": chains}


def print_verdicts(verdicts: list[Verdict], chain: str = "") -> None:
    """Print one line a metric and how many thresholds hold; under the chain's name if any."""
    console = new_console()
    if chain:
        console.print(Text(chain, "bold"))
    titles = ("metric", "", "value", "max", "unit", "verdict", "meaning")
    table = new_table(*titles, right=("value", "max"))
    colours = {PASSED: "green", FAILED: "red"}
    for verdict in verdicts:
        metric, word = verdict.metric, verdict.word
        shown = ["-" if x is None else f"{x:.4g}" for x in (verdict.value, verdict.most)]
        cells = [metric.name, metric.number, *shown, metric.unit]
        words = Text(word, style=colours.get(word, "dim"))
        table.add_row(*map(Text, cells), words, Text(verdict.reason or metric.meaning, "dim"))
    console.print(table)
    asked = [verdict for verdict in verdicts if verdict.most is not None]
    held = sum(verdict.word == PASSED for verdict in asked)
    console.print(f"{held} of {len(asked)} thresholds hold")
