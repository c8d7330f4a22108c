# The types of the module `poecal`; a test holds its names to the module's.
#
# Types, functions and members have the names of C++, which include/poecal documents. A function also has its PEP 8 name: readResults is
# read_results. Arrays are of doubles. What is read of an object is a copy where it is a list, a map, an array or may be None: change one
# and set it again.
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import ClassVar, Final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array = NDArray[np.float64]
_Path = str | os.PathLike[str]
_Progress = Callable[[str, int, int], object]  # told the name of the job, how many of its pieces are done, and of how many

__version__: str

class _Enum:
    __members__: ClassVar[dict[str, _Enum]]
    def __init__(self, value: int) -> None: ...
    def __int__(self) -> int: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Error(RuntimeError):
    def exitStatus(self) -> int: ...
    exit_status = exitStatus

class InvalidArgument(Error, ValueError): ...
class FileError(Error): ...
class ImplausibleInput(Error): ...

class ImplausibleCapture(ImplausibleInput):
    def part(self) -> InputPart: ...
    def sample(self) -> int | None: ...

class OutOfMemory(Error, MemoryError): ...
class InsufficientData(Error): ...

class InputPart(_Enum):
    kSamples: ClassVar[InputPart]
    kRobot: ClassVar[InputPart]
    kTarget: ClassVar[InputPart]
    kCamera: ClassVar[InputPart]
    kManifest: ClassVar[InputPart]
    kDetections: ClassVar[InputPart]
    kRegistration: ClassVar[InputPart]

class JointType(_Enum):
    kRevolute: ClassVar[JointType]
    kPrismatic: ClassVar[JointType]

class JointLimits:
    """Range of a joint reading [rad] or [m]."""
    lower: float
    upper: float
    def __init__(self, *, lower: float = ..., upper: float = ...) -> None: ...
    def __copy__(self) -> JointLimits: ...
    def __deepcopy__(self, memo: dict[int, object]) -> JointLimits: ...

class Joint:
    """One joint of the arm at q = 0, in base: its twist xi (w; v) and a point of its axis, the anchor."""
    name: str
    type: JointType
    xi: _Array
    anchor: _Array
    limits: JointLimits | None
    largest_speed: float | None
    def __init__(
        self, *, name: str = ..., type: JointType = ..., xi: ArrayLike = ..., anchor: ArrayLike = ..., limits: JointLimits | None = ...,
        largest_speed: float | None = ...
    ) -> None: ...
    def __copy__(self) -> Joint: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Joint: ...
    def axis(self) -> _Array:
        """Unit direction of the axis in base."""
    @staticmethod
    def revolute(name: str, axis: ArrayLike, point: ArrayLike) -> Joint: ...
    @staticmethod
    def prismatic(name: str, axis: ArrayLike, point: ArrayLike = ...) -> Joint: ...

class LinkMass:
    """The body that a joint moves: mass [kg] and centre of mass in base at q = 0 [m]."""
    mass: float
    com: _Array
    def __init__(self, *, mass: float = ..., com: ArrayLike = ...) -> None: ...
    def __copy__(self) -> LinkMass: ...
    def __deepcopy__(self, memo: dict[int, object]) -> LinkMass: ...

class AxisOffset:
    """The difference between two positions of one axis."""
    tilt: Final[float]
    shift: Final[float]

class Arm:
    """T_base_flange(q) = exp(xi_1 q_1) ... exp(xi_n q_n) exp(gamma)."""
    name: str
    joints: Sequence[Joint]
    gamma: _Array
    links: Sequence[LinkMass]
    def __init__(
        self, *, name: str = ..., joints: Sequence[Joint] = ..., gamma: ArrayLike = ..., links: Sequence[LinkMass] = ...
    ) -> None: ...
    def __copy__(self) -> Arm: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Arm: ...
    def jointCount(self) -> int: ...
    joint_count = jointCount

class DistortionModel(_Enum):
    kPlumbBob: ClassVar[DistortionModel]
    kRationalPolynomial: ClassVar[DistortionModel]
    kEquidistant: ClassVar[DistortionModel]
    kThinPrism: ClassVar[DistortionModel]

class Camera:
    """Intrinsics. The centre of the top-left pixel is (0, 0)."""
    name: str
    width: int
    height: int
    model: DistortionModel
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: _Array
    standard_deviation: _Array
    remarks: Sequence[str]
    def __init__(
        self, *, name: str = ..., width: int = ..., height: int = ..., model: DistortionModel = ..., fx: float = ..., fy: float = ...,
        cx: float = ..., cy: float = ..., distortion: ArrayLike = ..., standard_deviation: ArrayLike = ..., remarks: Sequence[str] = ...
    ) -> None: ...
    def __copy__(self) -> Camera: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Camera: ...
    def parameters(self) -> _Array:
        """fx fy cx cy, then the distortion coefficients."""
    def setParameters(self, parameters: ArrayLike) -> None: ...
    def parameterNames(self) -> list[str]: ...
    set_parameters = setParameters
    parameter_names = parameterNames

class TargetType(_Enum):
    kAprilTag: ClassVar[TargetType]
    kPoints: ClassVar[TargetType]
    kAprilGrid: ClassVar[TargetType]
    kCharuco: ClassVar[TargetType]
    kChessboard: ClassVar[TargetType]

class PointId:
    """Name of a point: tag id and corner 0..3; boards have tag -1 and the board's corner index."""
    tag: int
    corner: int
    def __init__(self, *, tag: int = ..., corner: int = ...) -> None: ...
    def __copy__(self) -> PointId: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PointId: ...
    def __eq__(self, other: object) -> bool: ...
    def __hash__(self) -> int: ...

class TargetPoint:
    """A named point of the target [m]."""
    id: PointId
    p_target: _Array
    def __init__(self, *, id: PointId = ..., p_target: ArrayLike = ...) -> None: ...
    def __copy__(self) -> TargetPoint: ...
    def __deepcopy__(self, memo: dict[int, object]) -> TargetPoint: ...

class TargetTag:
    """A tag in the target; its size is the edge between the corners [m]."""
    id: int
    size: float
    T_target_tag: _Array
    def __init__(self, *, id: int = ..., size: float = ..., T_target_tag: ArrayLike = ...) -> None: ...
    def __copy__(self) -> TargetTag: ...
    def __deepcopy__(self, memo: dict[int, object]) -> TargetTag: ...

class Target:
    """What is looked at, as named points. Made by apriltagTarget() and its like."""
    type: Final[TargetType]
    family: Final[str]
    tags: Final[tuple[TargetTag, ...]]
    cols: Final[int]
    rows: Final[int]
    square: Final[float]
    marker: Final[float]
    points: Final[tuple[TargetPoint, ...]]

class Setup(_Enum):
    kEyeToHand: ClassVar[Setup]
    kEyeInHand: ClassVar[Setup]

class Sample:
    """One row of samples.csv; what it lacks is empty or None."""
    image: str
    line: int
    q: _Array
    T_base_flange: _Array | None
    pose: int | None
    stamp: float | None
    temperature: float | None
    payload: float | None
    dir: _Array
    dq: _Array
    other: _Array
    def __init__(
        self, *, image: str = ..., line: int = ..., q: ArrayLike = ..., T_base_flange: ArrayLike | None = ..., pose: int | None = ...,
        stamp: float | None = ..., temperature: float | None = ..., payload: float | None = ..., dir: ArrayLike = ..., dq: ArrayLike = ...,
        other: ArrayLike = ...
    ) -> None: ...
    def __copy__(self) -> Sample: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Sample: ...

class SampleTable:
    """A table of samples, in the order taken."""
    file: Path
    samples: Sequence[Sample]
    other_columns: Sequence[str]
    has_joints: bool
    has_flange_poses: bool
    def __init__(
        self, *, file: _Path = ..., samples: Sequence[Sample] = ..., other_columns: Sequence[str] = ..., has_joints: bool = ...,
        has_flange_poses: bool = ...
    ) -> None: ...
    def __copy__(self) -> SampleTable: ...
    def __deepcopy__(self, memo: dict[int, object]) -> SampleTable: ...

class MeasuredPose:
    """One row of poses.csv: a pose that an instrument measured, or a position alone; deviations in [m] and [rad]."""
    sample: Sample
    T_instrument_tool: _Array
    position_only: bool
    sigma_position: float | None
    sigma_rotation: float | None
    def __init__(
        self, *, sample: Sample = ..., T_instrument_tool: ArrayLike = ..., position_only: bool = ..., sigma_position: float | None = ...,
        sigma_rotation: float | None = ...
    ) -> None: ...
    def __copy__(self) -> MeasuredPose: ...
    def __deepcopy__(self, memo: dict[int, object]) -> MeasuredPose: ...

class PoseTable:
    """A table of measured poses, in the order taken."""
    file: Path
    poses: Sequence[MeasuredPose]
    other_columns: Sequence[str]
    position_only: bool
    def __init__(
        self, *, file: _Path = ..., poses: Sequence[MeasuredPose] = ..., other_columns: Sequence[str] = ..., position_only: bool = ...
    ) -> None: ...
    def __copy__(self) -> PoseTable: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PoseTable: ...

class KnownTransform:
    """What is known of a constant transform: 1 sigma of its rotation and translation [rad; m]."""
    T: _Array
    sigma: _Array
    def __init__(self, *, T: ArrayLike = ..., sigma: ArrayLike = ...) -> None: ...
    def __copy__(self) -> KnownTransform: ...
    def __deepcopy__(self, memo: dict[int, object]) -> KnownTransform: ...

class Registration:
    """The two constant transforms around the arm."""
    setup: Setup
    T_camera_near: _Array
    T_far_target: _Array
    known_near: KnownTransform | None
    known_far: KnownTransform | None
    def __init__(
        self, *, setup: Setup = ..., T_camera_near: ArrayLike = ..., T_far_target: ArrayLike = ...,
        known_near: KnownTransform | None = ..., known_far: KnownTransform | None = ...
    ) -> None: ...
    def __copy__(self) -> Registration: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Registration: ...
    def nearFrame(self) -> str: ...
    def farFrame(self) -> str: ...
    def cameraTarget(self, T_base_flange: ArrayLike) -> _Array: ...
    def baseFlange(self, T_camera_target: ArrayLike) -> _Array: ...
    near_frame = nearFrame
    far_frame = farFrame
    camera_target = cameraTarget
    base_flange = baseFlange

class Cell:
    """Everything that turns a joint reading into pixels."""
    arm: Arm | None
    camera: Camera | None
    registration: Registration
    def __init__(self, *, arm: Arm | None = ..., camera: Camera | None = ..., registration: Registration = ...) -> None: ...
    def __copy__(self) -> Cell: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Cell: ...

class Corner:
    """One corner in a picture [px]; its sigma is NaN where not stated."""
    id: PointId
    px: _Array
    sigma: float
    def __init__(self, *, id: PointId = ..., px: ArrayLike = ..., sigma: float = ...) -> None: ...
    def __copy__(self) -> Corner: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Corner: ...

class CornerMeasurement:
    """A named point of the target [m] seen at a pixel; sigma per axis [px]."""
    id: PointId
    p_target: _Array
    px: _Array
    sigma_px: float
    def __init__(self, *, id: PointId = ..., p_target: ArrayLike = ..., px: ArrayLike = ..., sigma_px: float = ...) -> None: ...
    def __copy__(self) -> CornerMeasurement: ...
    def __deepcopy__(self, memo: dict[int, object]) -> CornerMeasurement: ...

class PoseMeasurement:
    """A measured pose; its residual (rotation [rad]; position [m] in camera) times `whitening` has unit covariance."""
    T_camera_target: _Array
    whitening: _Array
    position_only: bool
    def __init__(self, *, T_camera_target: ArrayLike = ..., whitening: ArrayLike = ..., position_only: bool = ...) -> None: ...
    def __copy__(self) -> PoseMeasurement: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PoseMeasurement: ...

class Observation:
    """All that one sample measured: corners, or a pose."""
    sample: int
    q: _Array
    T_base_flange: _Array | None
    corners: Sequence[CornerMeasurement]
    pose: PoseMeasurement | None
    reference: Sequence[CornerMeasurement]
    def __init__(
        self, *, sample: int = ..., q: ArrayLike = ..., T_base_flange: ArrayLike | None = ..., corners: Sequence[CornerMeasurement] = ...,
        pose: PoseMeasurement | None = ..., reference: Sequence[CornerMeasurement] = ...
    ) -> None: ...
    def __copy__(self) -> Observation: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Observation: ...

class Measurements:
    """All that was measured of a cell: either corners or poses."""
    setup: Setup
    target: Target
    samples: Sequence[Sample]
    other_columns: Sequence[str]
    observations: Sequence[Observation]
    sigmas_stated: bool
    groups: Sequence[Sequence[int]]
    gravity: _Array
    def __init__(
        self, *, setup: Setup = ..., target: Target = ..., samples: Sequence[Sample] = ..., other_columns: Sequence[str] = ...,
        observations: Sequence[Observation] = ..., sigmas_stated: bool = ..., groups: Sequence[Sequence[int]] = ...,
        gravity: ArrayLike = ...
    ) -> None: ...
    def __copy__(self) -> Measurements: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Measurements: ...
    def addPicture(self, sample: Sample, corners: Sequence[Corner]) -> None: ...
    def addPictures(self, table: SampleTable, px: ArrayLike, sigma: float | None = ...) -> None:
        """A picture for each row: px is N x m x 2, of target.points in their order, NaN for a point that is not seen."""
    def addPose(
        self, sample: Sample, T_instrument_tool: ArrayLike, sigma_position: float | None = ..., sigma_rotation: float | None = ...
    ) -> None: ...
    def addPoses(
        self, table: SampleTable, T_instrument_tool: ArrayLike, sigma_position: float | None = ..., sigma_rotation: float | None = ...
    ) -> None:
        """A pose for each row: N x 4 x 4, deviations in [m] and [rad]."""
    def addPosition(self, sample: Sample, p_instrument: ArrayLike, sigma_position: float | None = ...) -> None: ...
    def addPositions(self, table: SampleTable, p_instrument: ArrayLike, sigma_position: float | None = ...) -> None:
        """A position for each row: N x 3 [m]."""
    def poseGroups(self) -> list[list[int]]: ...
    add_picture = addPicture
    add_pictures = addPictures
    add_pose = addPose
    add_poses = addPoses
    add_position = addPosition
    add_positions = addPositions
    pose_groups = poseGroups

class Capture:
    """capture.yaml with everything that it names but the pictures."""
    folder: Final[Path]
    name: Final[str]
    setup: Final[Setup]
    camera: Final[Camera | None]
    target: Final[Target]
    gravity: Final[_Array]
    table: Final[SampleTable]
    arm: Final[Arm | None]

class EffectSpec:
    """An effect as a file says it: what, where, how large, what drives it."""
    effect: str
    location: str
    parameters: Mapping[str, float]
    driver: str
    def __init__(self, *, effect: str = ..., location: str = ..., parameters: Mapping[str, float] = ..., driver: str = ...) -> None: ...
    def __copy__(self) -> EffectSpec: ...
    def __deepcopy__(self, memo: dict[int, object]) -> EffectSpec: ...

class EffectParameter:
    """A parameter of an effect: `typical` is 1 sigma of its size on real cells."""
    name: Final[str]
    unit: Final[str]
    typical: Final[float]

class EffectKind:
    """A kind of effect."""
    name: Final[str]
    drivers: Final[tuple[str, ...]]
    parameters: Final[tuple[EffectParameter, ...]]
    meaning: Final[str]
    formula: Final[str]
    confused_with: Final[tuple[str, ...]]
    separate: Final[str]
    remedy: Final[str]
    def placePattern(self) -> str: ...
    place_pattern = placePattern

class Effect:
    """One effect at one place."""
    def name(self) -> str: ...
    def location(self) -> str: ...
    def kind(self) -> EffectKind: ...
    def parameters(self) -> list[EffectParameter]: ...
    def spec(self, parameters: ArrayLike) -> EffectSpec: ...

class AppliedEffect:
    """An effect with values."""
    effect: Final[Effect]
    parameters: _Array
    standard_deviation: _Array

class Model:
    """The calibrated cell, with the effects that a diagnosis found."""
    cell: Cell
    target: Target | None
    gravity: _Array
    effects: Sequence[AppliedEffect]
    driver_ranges: Mapping[str, tuple[float, float]]
    method: str
    urdf: str
    base_link: str
    tip_link: str
    def __init__(
        self, *, cell: Cell = ..., target: Target | None = ..., gravity: ArrayLike = ..., effects: Sequence[AppliedEffect] = ...,
        driver_ranges: Mapping[str, tuple[float, float]] = ..., method: str = ..., urdf: str = ..., base_link: str = ..., tip_link: str = ...
    ) -> None: ...
    def __copy__(self) -> Model: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Model: ...

class RealArm:
    """The arm as it really moves: calibrated axes, and effects."""
    arm: Arm
    effects: Sequence[AppliedEffect]
    gravity: _Array
    def __init__(self, *, arm: Arm = ..., effects: Sequence[AppliedEffect] = ..., gravity: ArrayLike = ...) -> None: ...
    def __copy__(self) -> RealArm: ...
    def __deepcopy__(self, memo: dict[int, object]) -> RealArm: ...

class JointCommand:
    """What to command for one wanted pose; `why_not` is empty where it is reached."""
    start: Final[_Array]
    q: Final[_Array]
    T_base_flange: Final[_Array]
    position_error: Final[float]
    rotation_error: Final[float]
    why_not: Final[str]

class LengthSummary:
    """Mean, median, root mean square, 95 % quantile and maximum of lengths."""
    mean: Final[float]
    median: Final[float]
    rms: Final[float]
    p95: Final[float]
    max: Final[float]

class ErrorSummary:
    """Errors of a set of poses: corners [px], position [m] and rotation [rad] of the flange."""
    poses: Final[int]
    corners: Final[int]
    px: Final[LengthSummary]
    position: Final[LengthSummary]
    rotation: Final[LengthSummary]

class FlangeError:
    """Distance [m] and angle [rad] of a flange from where it is."""
    position: Final[float]
    rotation: Final[float]

class RowErrors:
    """Errors of one observation: `lengths` of its corners [px], of poses the distance [m]."""
    index: Final[int]
    lengths: Final[_Array]

class ModelStage:
    """One model stage: nominal, registered, identified."""
    name: Final[str]
    calibration: Final[ErrorSummary]
    held_out: Final[ErrorSummary]
    held_out_kept: Final[ErrorSummary]
    held_out_rows: Final[tuple[RowErrors, ...]]

class AdjustmentStatus(_Enum):
    kNotRun: ClassVar[AdjustmentStatus]
    kConverged: ClassVar[AdjustmentStatus]
    kIterationLimit: ClassVar[AdjustmentStatus]

class AdjustmentStep:
    """One step of an adjustment; `rms` is in stated sigmas."""
    cost: Final[float]
    rms: Final[float]
    scale: Final[float]

class Adjustment:
    """A cell fitted to what was measured: `covariance` is of the parameters of `names` [rad; m], `scale` the noise in stated sigmas,
    `weights` of every observation's units 0..1."""
    status: Final[AdjustmentStatus]
    cell: Final[Cell]
    beta: Final[_Array]
    names: Final[tuple[str, ...]]
    sigma_prior: Final[_Array]
    covariance: Final[_Array]
    steps: Final[tuple[AdjustmentStep, ...]]
    scale: Final[float]
    tolerance: Final[float]
    chi_square: Final[float]
    degrees_of_freedom: Final[float]
    rank: Final[int]
    condition_number: Final[float]
    weights: Final[tuple[_Array, ...]]
    unseen: Final[tuple[str, ...]]
    def reducedChiSquare(self) -> float: ...
    reduced_chi_square = reducedChiSquare

class RegisteredSample:
    """One sample after registration."""
    sample: Final[int]
    rms_px: Final[float]
    free_rms_px: Final[float]
    left_out: Final[bool]
    has_pose: Final[bool]
    T_camera_target: Final[_Array]
    T_base_flange: Final[_Array]
    covariance: Final[_Array]

class RegistrationResult:
    """Where camera and target are, and the flange poses that the camera measured."""
    cell: Final[Cell]
    closed_form: Final[Registration]
    adjustment: Final[Adjustment]
    samples: Final[tuple[RegisteredSample, ...]]
    rms_px: Final[float]
    rms_all_px: Final[float]
    free_rms_px: Final[float]
    corner_sigma_px: Final[float]
    warnings: Final[tuple[str, ...]]

class PoseRegistration:
    """Where an instrument and its tool are; warnings of known transforms."""
    adjustment: Final[Adjustment]
    warnings: Final[tuple[str, ...]]

class Method(_Enum):
    kGao: ClassVar[Method]
    kWeighted: ClassVar[Method]
    kBundle: ClassVar[Method]

class SuspectRow:
    """A row that the model contradicts."""
    sample: Final[int]
    residual: Final[float]
    sigmas: Final[float]
    left_out: Final[bool]

class JointDeviation:
    """How an axis stands in the link before it, and where the joint's zero is."""
    tilt: Final[float]
    shift: Final[float]
    zero: Final[float]

class Identification:
    """The arm's axes, and how well the data show them."""
    method: Final[Method]
    model: Final[Model]
    nominal: Final[Arm]
    stages: Final[tuple[ModelStage, ...]]
    suspects: Final[tuple[SuspectRow, ...]]
    poses: Final[int]
    held_out_poses: Final[int]
    leave_one_out: Final[bool]
    corner_noise: Final[float]
    sigmas_stated: Final[bool]
    scale: Final[float]
    sigma_position: Final[float]
    sigma_rotation: Final[float]
    reduced_chi_square: Final[float]
    degrees_of_freedom: Final[float]
    arm_beyond_tolerance: Final[float]
    joint_deviations: Final[tuple[JointDeviation, ...]]
    parameter_names: Final[tuple[str, ...]]
    parameter_deviation: Final[_Array]
    prior_share: Final[_Array]
    rank: Final[int]
    condition_number: Final[float]
    unseen: Final[tuple[str, ...]]
    gauge: Final[tuple[str, ...]]
    camera_refitted: Final[bool]
    warnings: Final[tuple[str, ...]]

class NoiseSource(_Enum):
    kRepeats: ClassVar[NoiseSource]
    kGiven: ClassVar[NoiseSource]
    kEstimated: ClassVar[NoiseSource]
    kUnknown: ClassVar[NoiseSource]

class GapStage:
    """One model stage on poses that its fit did not see: `rms` and `excess` in [px], or [m] for poses."""
    stage: Final[str]
    errors: Final[ErrorSummary]
    rms: Final[float]
    excess: Final[float]
    rms_interval: Final[tuple[float, float]]

class Shrinkage:
    """How much smaller the excess became, with its 95 % interval."""
    value: Final[float]
    interval: Final[tuple[float, float]]
    def claimed(self) -> bool: ...

class GapPlace:
    """A place and a driver at which what identification left shows structure."""
    location: Final[str]
    driver: Final[str]
    share: Final[float]
    p_value: Final[float]

class Detectable:
    """The smallest size that would have been seen four times in five."""
    effect: Final[str]
    location: Final[str]
    smallest: Final[float]
    unit: Final[str]

class NotTestable:
    """An effect that these data cannot show, and why."""
    effect: Final[str]
    location: Final[str]
    why: Final[str]

class BadSample:
    """A sample that belongs to no model."""
    sample: Final[int]
    residual: Final[float]

class AlternativeCause:
    """Another hypothesis that the data cannot exclude beside a finding."""
    effect: Final[str]
    location: Final[str]
    driver: Final[str]
    probability: Final[float]

class Finding:
    """An effect at a place that the diagnosis holds to be real, with its size."""
    effect: Final[str]
    location: Final[str]
    driver: Final[str]
    parameters: Final[Mapping[str, float]]
    standard_deviation: Final[Mapping[str, float]]
    units: Final[Mapping[str, str]]
    probability: Final[float]
    p_value: Final[float]
    log_evidence: Final[float]
    shrinkage: Final[Shrinkage]
    alternatives: Final[tuple[AlternativeCause, ...]]
    separate_with: Final[str]
    reference: Final[str]
    largest_deflection: Final[float | None]
    largest_deflection_deviation: Final[float | None]
    remedy: Final[str]
    images: Final[tuple[str, ...]]

class Diagnosis:
    """Where the gap lies, which effect causes it, how far it shrinks."""
    pixels: Final[bool]
    noise_sigma: Final[float]
    noise_source: Final[NoiseSource]
    noise_rms: Final[float]
    noise_bounds: Final[tuple[float, float]]
    stages: Final[tuple[GapStage, ...]]
    before_excess: Final[float]
    after_excess: Final[float]
    after_interval: Final[tuple[float, float]]
    shrinkage: Final[Shrinkage]
    findings: Final[tuple[Finding, ...]]
    possibilities: Final[tuple[Finding, ...]]
    warnings: Final[tuple[str, ...]]
    where: Final[tuple[GapPlace, ...]]
    gap_remains: Final[bool]
    remaining_significant: Final[bool]
    remaining_location: Final[str]
    remaining_driver: Final[str]
    detectable: Final[tuple[Detectable, ...]]
    not_testable: Final[tuple[NotTestable, ...]]
    bad_samples: Final[tuple[BadSample, ...]]
    model: Final[Model]
    def isClean(self) -> bool: ...
    is_clean = isClean
    def noiseKnown(self) -> bool: ...
    noise_known = noiseKnown

class TextLength(_Enum):
    kWhole: ClassVar[TextLength]
    kScreen: ClassVar[TextLength]

class ModelSource(_Enum):
    kIdentified: ClassVar[ModelSource]
    kDiagnosed: ClassVar[ModelSource]

class Calibration:
    """What a calibration gave; steps that were not done are None."""
    registration: Final[RegistrationResult | None]
    identification: Final[Identification | None]
    diagnosis: Final[Diagnosis | None]
    no_diagnosis: Final[str]
    model: Final[Model | None]
    model_source: Final[ModelSource]
    model_reason: Final[str]
    warnings: Final[tuple[str, ...]]

class StageErrors:
    """Errors of one model stage on held-out poses: rms [px], mean position [mm] and rotation [mrad]."""
    stage: Final[str]
    rms_px: Final[float | None]
    position: Final[float | None]
    rotation: Final[float | None]

class FindingSummary:
    """One finding of diagnosis.json in a few words."""
    effect: Final[str]
    location: Final[str]
    size: Final[str]
    driver: Final[str]
    probability: Final[float]
    alternatives: Final[tuple[AlternativeCause, ...]]
    separate_with: Final[str]

class ResultSummary:
    """What the results in a folder say in short."""
    folder: Final[Path]
    name: Final[str]
    pictures: Final[int | None]
    pictures_with_corners: Final[int | None]
    pictures_left_out: Final[int | None]
    registration_px: Final[float | None]
    free_pose_px: Final[float | None]
    poses: Final[int | None]
    stages: Final[tuple[StageErrors, ...]]
    verdict: Final[str | None]
    why: Final[str]
    findings: Final[tuple[FindingSummary, ...]]
    structure_left: Final[bool]
    gap_remains: Final[bool]
    diagnosed: Final[StageErrors | None]
    shrinkage: Final[float | None]
    shrinkage_low: Final[float | None]
    shrinkage_high: Final[float | None]
    bad_samples: Final[int | None]
    bad_images: Final[tuple[str, ...]]
    warnings: Final[tuple[str, ...]]
    corner_sigma_px: Final[float | None]
    arm_beyond_tolerance: Final[float | None]
    def isUnexplained(self) -> bool:
        """Whether something is left that no finding explains, of either kind."""
    def stage(self, stage: str) -> StageErrors | None:
        """The errors of a stage; None where it is not there."""
    is_unexplained = isUnexplained

class CalibrationStep(_Enum):
    kRegistration: ClassVar[CalibrationStep]
    kIdentification: ClassVar[CalibrationStep]
    kDiagnosis: ClassVar[CalibrationStep]

class CameraChoice(_Enum):
    kStated: ClassVar[CameraChoice]
    kFree: ClassVar[CameraChoice]
    kAuto: ClassVar[CameraChoice]

class RegistrationOptions:
    """Options of the registration."""
    hypotheses: int
    robust: bool
    leave_out_bad: bool
    progress: _Progress | None
    def __init__(
        self, *, hypotheses: int = ..., robust: bool = ..., leave_out_bad: bool = ..., progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> RegistrationOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> RegistrationOptions: ...

class IdentifyOptions:
    """Options of the identification; calibrate() has `jobs` and `progress` of its own."""
    method: Method
    tolerance_position: float
    tolerance_rotation: float
    camera: CameraChoice
    robust: bool
    gao_length_unit: float
    hold_out_every: int
    leave_one_out: bool
    registered: bool
    jobs: int
    allow_still_joints: bool
    progress: _Progress | None
    def __init__(
        self, *, method: Method = ..., tolerance_position: float = ..., tolerance_rotation: float = ..., camera: CameraChoice = ...,
        robust: bool = ..., gao_length_unit: float = ..., hold_out_every: int = ..., leave_one_out: bool = ..., registered: bool = ...,
        jobs: int = ..., allow_still_joints: bool = ..., progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> IdentifyOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> IdentifyOptions: ...

class DiagnoseOptions:
    """Options of the diagnosis; calibrate() has `jobs` and `progress` of its own."""
    folds: int
    seed: int
    jobs: int
    progress: _Progress | None
    def __init__(self, *, folds: int = ..., seed: int = ..., jobs: int = ..., progress: _Progress | None = ...) -> None: ...
    def __copy__(self) -> DiagnoseOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> DiagnoseOptions: ...

class CalibrateOptions:
    """Options of a calibration. The result does not depend on `jobs`; `progress` is told of every step."""
    last: CalibrationStep
    identify: IdentifyOptions
    diagnose: DiagnoseOptions
    jobs: int
    progress: _Progress | None
    def __init__(
        self, *, last: CalibrationStep = ..., identify: IdentifyOptions = ..., diagnose: DiagnoseOptions = ..., jobs: int = ...,
        progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> CalibrateOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> CalibrateOptions: ...

class CaptureSource:
    """A capture folder, and files that take the place of what it names. A path is one too."""
    folder: Path
    intrinsics: Path
    detections: Path
    identified: Path
    def __init__(self, folder: _Path, intrinsics: _Path = ..., detections: _Path = ..., identified: _Path = ...) -> None: ...

class PosesSource:
    """An arm's file, and poses of any instrument."""
    robot: Path
    poses: Path
    base_link: str
    tip_link: str
    registration: Path
    def __init__(
        self, *, robot: _Path = ..., poses: _Path = ..., base_link: str = ..., tip_link: str = ..., registration: _Path = ...
    ) -> None: ...
    def __copy__(self) -> PosesSource: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PosesSource: ...

class ResultFiles:
    """Which files to write."""
    registration: bool
    identification: bool
    diagnosis: bool
    def __init__(self, *, registration: bool = ..., identification: bool = ..., diagnosis: bool = ...) -> None: ...
    def __copy__(self) -> ResultFiles: ...
    def __deepcopy__(self, memo: dict[int, object]) -> ResultFiles: ...

class Listener:
    """Hears what a long job has to say; override what is of interest."""
    def __init__(self) -> None: ...
    def warning(self, message: str) -> None: ...
    def warnings(self, messages: Sequence[str]) -> None: ...
    def progress(self, label: str, done: int, total: int) -> None: ...

class CalibrationRun:
    """A calibration with what it was made from."""
    measurements: Final[Measurements]
    calibration: Final[Calibration]

class LoadedCapture:
    """A capture with what its pictures gave."""
    capture: Final[Capture]
    nominal: Final[Cell]
    measurements: Final[Measurements]

class IntrinsicsOptions:
    """Options of a camera's calibration."""
    model: DistortionModel
    max_iterations: int
    robust: bool
    bad_view_sigmas: float
    bad_view_factor: float
    progress: _Progress | None
    def __init__(
        self, *, model: DistortionModel = ..., max_iterations: int = ..., robust: bool = ..., bad_view_sigmas: float = ...,
        bad_view_factor: float = ..., progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> IntrinsicsOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> IntrinsicsOptions: ...

class ProjectionUncertainty:
    """What a camera's covariance means in the picture."""
    median_px: Final[float]
    largest_px: Final[float]

class IntrinsicsFit:
    """A camera fitted to some pictures."""
    camera: Final[Camera]
    held: Final[tuple[str, ...]]
    covariance: Final[_Array]
    uncertainty: Final[ProjectionUncertainty]
    rms_px: Final[float]
    sigma_px: Final[float]
    pictures: Final[int]
    points: Final[int]
    outliers: Final[int]
    converged: Final[bool]

class ViewResidual:
    """A picture's residuals under the chosen camera."""
    image: Final[str]
    points: Final[int]
    used: Final[bool]
    bad: Final[bool]
    left_out: Final[bool]
    rms_px: Final[float]
    max_px: Final[float]
    T_camera_target: Final[_Array]

class IntrinsicsResult:
    """Plain and robust fit; chosen() is the one that was asked for."""
    all: Final[IntrinsicsFit]
    robust: Final[IntrinsicsFit]
    is_robust: Final[bool]
    views: Final[tuple[ViewResidual, ...]]
    warnings: Final[tuple[str, ...]]
    def chosen(self) -> IntrinsicsFit: ...

class CheckLevel(_Enum):
    kOk: ClassVar[CheckLevel]
    kAdvice: ClassVar[CheckLevel]
    kTooLittle: ClassVar[CheckLevel]
    kError: ClassVar[CheckLevel]

class CheckItem:
    """One line about a capture."""
    level: Final[CheckLevel]
    topic: Final[str]
    text: Final[str]

class CaptureCheck:
    """What is there, what is wrong, what would help."""
    items: Final[tuple[CheckItem, ...]]
    def exitStatus(self) -> int: ...
    exit_status = exitStatus

class CheckOptions:
    """Options of a check."""
    detect: int
    jobs: int
    progress: _Progress | None
    def __init__(self, *, detect: int = ..., jobs: int = ..., progress: _Progress | None = ...) -> None: ...
    def __copy__(self) -> CheckOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> CheckOptions: ...

class NewCapture:
    """What is known before the first picture is taken."""
    folder: Path
    robot: Path
    base_link: str
    tip_link: str
    target: Path
    camera: Path
    board: Path
    setup: Setup
    def __init__(
        self, *, folder: _Path = ..., robot: _Path = ..., base_link: str = ..., tip_link: str = ..., target: _Path = ...,
        camera: _Path = ..., board: _Path = ..., setup: Setup = ...
    ) -> None: ...
    def __copy__(self) -> NewCapture: ...
    def __deepcopy__(self, memo: dict[int, object]) -> NewCapture: ...

class PictureLook:
    """What a picture looks like: blur [px] and noise [grey levels of 255], 1 sigma; growth of dark into light [px]."""
    blur: float
    noise: float
    growth: float
    def __init__(self, *, blur: float = ..., noise: float = ..., growth: float = ...) -> None: ...
    def __copy__(self) -> PictureLook: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PictureLook: ...

class ImageCorners:
    """The corners of one picture, sorted by id."""
    image: str
    corners: Sequence[Corner]
    look: PictureLook | None
    def __init__(self, *, image: str = ..., corners: Sequence[Corner] = ..., look: PictureLook | None = ...) -> None: ...
    def __copy__(self) -> ImageCorners: ...
    def __deepcopy__(self, memo: dict[int, object]) -> ImageCorners: ...

class Detections:
    """Pictures in the order of the capture, with their corners."""
    images: Sequence[ImageCorners]
    def __init__(self, *, images: Sequence[ImageCorners] = ...) -> None: ...
    def __copy__(self) -> Detections: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Detections: ...
    def find(self, image: str) -> ImageCorners | None:
        """A picture's corners; None where it is not there."""

class DetectOptions:
    """Options of a detection; the result does not depend on `jobs`."""
    jobs: int
    quad_decimate: float
    refine: bool
    camera: Camera | None
    expected_width: int
    expected_height: int
    other_tags: Sequence[int]
    progress: _Progress | None
    def __init__(
        self, *, jobs: int = ..., quad_decimate: float = ..., refine: bool = ..., camera: Camera | None = ..., expected_width: int = ...,
        expected_height: int = ..., other_tags: Sequence[int] = ..., progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> DetectOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> DetectOptions: ...

class PictureNote:
    """A remark about one picture; `failed`: no corners came from it."""
    image: Final[str]
    message: Final[str]
    failed: Final[bool]
    def text(self) -> str:
        """The picture and the message."""

class DetectResult:
    """Corners of each picture in the order given, remarks, and the pictures' size [px]."""
    detections: Final[Detections]
    notes: Final[tuple[PictureNote, ...]]
    width: Final[int]
    height: Final[int]

class KnownCorners:
    """Corners found before, kept in a file: no picture is searched twice."""
    def __init__(self, file: _Path) -> None: ...
    def read(self, file: _Path) -> None:
        """Takes in what another such file knows."""
    def finish(self) -> None:
        """Rewrites the file with what was asked for or added alone, sorted."""
    def reused(self) -> int:
        """How many pictures were not searched again."""

class BoardView:
    """A board's points in one picture: 3 x N p_target [m], 2 x N pixels [px], N sigmas [px] or none."""
    image: str
    points: _Array
    pixels: _Array
    sigmas: _Array
    def __init__(self, *, image: str = ..., points: ArrayLike = ..., pixels: ArrayLike = ..., sigmas: ArrayLike = ...) -> None: ...
    def __copy__(self) -> BoardView: ...
    def __deepcopy__(self, memo: dict[int, object]) -> BoardView: ...

class BoardPictures:
    """A folder of pictures of a board: a view each, remarks, and the pictures' size [px]."""
    target: Final[Target]
    views: Final[tuple[BoardView, ...]]
    notes: Final[tuple[PictureNote, ...]]
    width: Final[int]
    height: Final[int]

class ImageOptions:
    """How pictures are drawn: blur [px] and noise [grey levels of 255], 1 sigma; background "clutter" or "plain"."""
    blur: float
    noise: float
    background: str
    def __init__(self, *, blur: float = ..., noise: float = ..., background: str = ...) -> None: ...
    def __copy__(self) -> ImageOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> ImageOptions: ...

class Scene:
    """A cell whose truth is known: what is true, what the capture is told, and what is drawn."""
    file: Path
    name: str
    nominal: Arm
    robot_file: Path
    base_link: str
    tip_link: str
    actual: Arm
    camera: Camera
    stated_camera: Camera
    target: Target
    stated_target: Target
    registration: Registration
    effects: Sequence[AppliedEffect]
    count: int
    seed: int
    repeats: int
    samples_file: Path
    image: ImageOptions | None
    looks: Sequence[PictureLook]
    corner_sigma: float | None
    board: Target | None
    board_count: int
    def __init__(
        self, *, file: _Path = ..., name: str = ..., nominal: Arm = ..., robot_file: _Path = ..., base_link: str = ..., tip_link: str = ...,
        actual: Arm = ..., camera: Camera = ..., stated_camera: Camera = ..., target: Target = ..., stated_target: Target = ...,
        registration: Registration = ..., effects: Sequence[AppliedEffect] = ..., count: int = ..., seed: int = ..., repeats: int = ...,
        samples_file: _Path = ..., image: ImageOptions | None = ..., looks: Sequence[PictureLook] = ..., corner_sigma: float | None = ...,
        board: Target | None = ..., board_count: int = ...
    ) -> None: ...
    def __copy__(self) -> Scene: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Scene: ...

class SimulateOptions:
    """Options of a simulation; the result does not depend on `jobs`."""
    jobs: int
    progress: _Progress | None
    def __init__(self, *, jobs: int = ..., progress: _Progress | None = ...) -> None: ...
    def __copy__(self) -> SimulateOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> SimulateOptions: ...

class SimulateSummary:
    """What a simulation wrote; `truth` is the truth's folder."""
    poses: Final[int]
    samples: Final[int]
    without_target: Final[int]
    corners: Final[int]
    pictures: Final[bool]
    boards: Final[int]
    truth: Final[Path]

class PlanNoise:
    """Noise of the pictures to come, 1 sigma: of a corner and of a whole tag [px], of each joint's repeats [rad]."""
    corner: float
    tag: float
    repeatability: float
    def __init__(self, *, corner: float = ..., tag: float = ..., repeatability: float = ...) -> None: ...
    def __copy__(self) -> PlanNoise: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PlanNoise: ...

class Rival:
    """An explanation that a diagnosis left open."""
    effect: str
    location: str
    driver: str
    probability: float
    def __init__(self, *, effect: str = ..., location: str = ..., driver: str = ..., probability: float = ...) -> None: ...
    def __copy__(self) -> Rival: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Rival: ...

class Rivals:
    """Explanations of one finding of which one is right; the finding itself is the first."""
    explanations: Sequence[Rival]
    separate_with: str
    def __init__(self, *, explanations: Sequence[Rival] = ..., separate_with: str = ...) -> None: ...
    def __copy__(self) -> Rivals: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Rivals: ...

class PlanningCell:
    """A cell and all that is known of it before the poses that are planned; positions in [m], rotations in [rad], 1 sigma."""
    nominal: Cell
    model: Model
    target: Target
    taken: Measurements
    robot_file: Path
    noise: PlanNoise
    tolerance_position: float
    tolerance_rotation: float
    arm_beyond_tolerance: float
    rough_position: float
    rough_rotation: float
    open: Sequence[Rivals]
    def __init__(
        self, *, nominal: Cell = ..., model: Model = ..., target: Target = ..., taken: Measurements = ..., robot_file: _Path = ...,
        noise: PlanNoise = ..., tolerance_position: float = ..., tolerance_rotation: float = ..., arm_beyond_tolerance: float = ...,
        rough_position: float = ..., rough_rotation: float = ..., open: Sequence[Rivals] = ...
    ) -> None: ...
    def __copy__(self) -> PlanningCell: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PlanningCell: ...

class PlanSource:
    """A capture, and the model.yaml that was found from it."""
    capture: CaptureSource
    model: Path
    def __init__(self, *, capture: CaptureSource | _Path = ..., model: _Path = ...) -> None: ...
    def __copy__(self) -> PlanSource: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PlanSource: ...

class FirstCapture:
    """Before the first picture: files, and where camera and target roughly are [m], [rad]: in base and in flange; eye in hand: in flange
    and in base."""
    robot: Path
    camera: Path
    target: Path
    base_link: str
    tip_link: str
    setup: Setup
    registration: Path
    camera_at: _Array | None
    look_at: _Array | None
    target_at: _Array
    target_faces: _Array
    rough_position: float
    corner_sigma: float
    rough_rotation: float
    def __init__(
        self, *, robot: _Path = ..., camera: _Path = ..., target: _Path = ..., base_link: str = ..., tip_link: str = ...,
        setup: Setup = ..., registration: _Path = ..., camera_at: ArrayLike | None = ..., look_at: ArrayLike | None = ...,
        target_at: ArrayLike = ..., target_faces: ArrayLike = ..., rough_position: float = ..., corner_sigma: float = ...,
        rough_rotation: float = ...
    ) -> None: ...
    def __copy__(self) -> FirstCapture: ...
    def __deepcopy__(self, memo: dict[int, object]) -> FirstCapture: ...

class PlanAim(_Enum):
    """What the poses are for."""
    kTool: ClassVar[PlanAim]
    kSeparate: ClassVar[PlanAim]
    kDetect: ClassVar[PlanAim]

class PlanCriterion(_Enum):
    """A: mean variance of the tool's position. D: volume of the confidence region."""
    kA: ClassVar[PlanCriterion]
    kD: ClassVar[PlanCriterion]

class PlanOptions:
    """Options of a plan; radii and the floor's height in [m]. The result does not depend on `jobs`."""
    aim: PlanAim
    criterion: PlanCriterion
    count: int
    candidates: int
    seed: int
    link_radius: float
    camera_radius: float
    floor: float | None
    detect: str
    detect_size: float
    odds: float
    jobs: int
    progress: _Progress | None
    def __init__(
        self, *, aim: PlanAim = ..., criterion: PlanCriterion = ..., count: int = ..., candidates: int = ..., seed: int = ...,
        link_radius: float = ..., camera_radius: float = ..., floor: float | None = ..., detect: str = ..., detect_size: float = ...,
        odds: float = ..., jobs: int = ..., progress: _Progress | None = ...
    ) -> None: ...
    def __copy__(self) -> PlanOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PlanOptions: ...

class ToolUncertainty:
    """Error of the tool before the camera, 1 sigma, mean over the workspace [m], [rad]."""
    position: Final[float]
    rotation: Final[float]

class PlannedPose:
    """Joint readings [rad] or [m], and the side from which each joint is to come: -1, 0, 1."""
    q: Final[_Array]
    dir: Final[_Array]

class RivalOdds:
    """Odds of the better of two rivals, where the first is right."""
    right: Final[str]
    wrong: Final[str]
    before: Final[float]
    expected: Final[float]

class Detection:
    """How well an effect of the size asked for would show."""
    chi_square: Final[float]
    probability: Final[float]

class Plan:
    """Poses in an order that makes a short path, and what they bring."""
    poses: Final[tuple[PlannedPose, ...]]
    before: Final[ToolUncertainty]
    after: Final[ToolUncertainty]
    random_poses: Final[int | None]
    random_tried: Final[int]
    odds: Final[tuple[RivalOdds, ...]]
    not_told: Final[tuple[str, ...]]
    detection_before: Final[Detection | None]
    detection_after: Final[Detection | None]
    sides_matter: Final[bool]
    link_radius: Final[float]
    visible: Final[int]
    drawn: Final[int]

class DhRule(_Enum):
    """Denavit and Hartenberg's rule, or Hayati's of nearly parallel axes."""
    kDh: ClassVar[DhRule]
    kHayati: ClassVar[DhRule]

class DhRow:
    """One joint: Rz(theta) Tz(d) Tx(a) Rx(alpha) Ry(beta) in [m] and [rad]; q is added at theta or d."""
    rule: DhRule
    a: float
    alpha: float
    d: float
    theta: float
    beta: float
    def __init__(
        self, *, rule: DhRule = ..., a: float = ..., alpha: float = ..., d: float = ..., theta: float = ..., beta: float = ...
    ) -> None: ...
    def __copy__(self) -> DhRow: ...
    def __deepcopy__(self, memo: dict[int, object]) -> DhRow: ...

class DhTable:
    """T_base_flange(q) = base A_1(q_1) ... A_n(q_n) tool."""
    base: _Array
    rows: Sequence[DhRow]
    tool: _Array
    def __init__(self, *, base: ArrayLike = ..., rows: Sequence[DhRow] = ..., tool: ArrayLike = ...) -> None: ...
    def __copy__(self) -> DhTable: ...
    def __deepcopy__(self, memo: dict[int, object]) -> DhTable: ...
    def plain(self) -> bool:
        """Whether the rows alone describe the arm."""

class DhTables:
    """The nominal arm and the calibrated one by the same rules and signs."""
    nominal: DhTable
    calibrated: DhTable
    def __init__(self, *, nominal: DhTable = ..., calibrated: DhTable = ...) -> None: ...
    def __copy__(self) -> DhTables: ...
    def __deepcopy__(self, memo: dict[int, object]) -> DhTables: ...

class FrameNames:
    """Names of the frames in what is written."""
    base: str
    flange: str
    camera: str
    target: str
    def __init__(self, *, base: str = ..., flange: str = ..., camera: str = ..., target: str = ...) -> None: ...
    def __copy__(self) -> FrameNames: ...
    def __deepcopy__(self, memo: dict[int, object]) -> FrameNames: ...

class PaperOptions:
    """Options of the paper's experiment; the noise of measured poses is uniform: half widths in [m] and [rad]."""
    seeds: int
    poses: int
    test_poses: int
    noise_position: float
    noise_rotation: float
    def __init__(
        self, *, seeds: int = ..., poses: int = ..., test_poses: int = ..., noise_position: float = ..., noise_rotation: float = ...
    ) -> None: ...
    def __copy__(self) -> PaperOptions: ...
    def __deepcopy__(self, memo: dict[int, object]) -> PaperOptions: ...

class PaperFit:
    """What one method made of one seed: the arm, and its errors at poses that it did not see."""
    arm: Final[Arm]
    residuals: Final[_Array]
    test_poses: Final[tuple[FlangeError, ...]]
    error: Final[FlangeError]

class PaperSeed:
    """One seed of the experiment."""
    nominal_test_poses: Final[tuple[FlangeError, ...]]
    nominal: Final[FlangeError]
    gao: Final[PaperFit]
    weighted: Final[PaperFit]

class Paper:
    """A sheet of paper, either way up [m]."""
    name: str
    width: float
    height: float
    def __init__(self, *, name: str = ..., width: float = ..., height: float = ...) -> None: ...
    def __copy__(self) -> Paper: ...
    def __deepcopy__(self, memo: dict[int, object]) -> Paper: ...

class SheetPage:
    """One page [m]. Its frame: origin in the top-left corner, x right, y down, z into the paper; the SVG is in millimetres."""
    svg: Final[str]
    width: Final[float]
    height: Final[float]
    tags: Final[tuple[int, ...]]
    T_page_target: Final[_Array]
    ruler: Final[float]
    ruler_corner: Final[_Array]

class TargetSheet:
    """A target to print: all pages as one PDF, and each by itself."""
    pages: Final[tuple[SheetPage, ...]]
    pdf: Final[bytes]

def expSe3(xi: ArrayLike) -> _Array:
    """exp of the twist (w; v) [rad; m]."""
exp_se3 = expSe3

def logSe3(T: ArrayLike) -> _Array:
    """Twist (w; v) with |w| <= pi whose exponential is T."""
log_se3 = logSe3

def poseFromQuaternion(position: ArrayLike, quaternion_xyzw: ArrayLike) -> _Array:
    """Pose from a translation and a quaternion (x, y, z, w) of any length but zero."""
pose_from_quaternion = poseFromQuaternion

def quaternionXyzw(T: ArrayLike) -> _Array:
    """Unit quaternion (x, y, z, w) of a pose's rotation, w >= 0."""
quaternion_xyzw = quaternionXyzw

def rotationAngle(R: ArrayLike) -> float:
    """Angle of a rotation [rad], 0..pi."""
rotation_angle = rotationAngle

def axisOffset(from_: Joint, to: Joint) -> AxisOffset:
    """Angle [rad] between two axes, and distance [m]."""
axis_offset = axisOffset

def forwardKinematics(arm: Arm, q: ArrayLike) -> _Array:
    """T_base_flange(q): 4 x 4 of n readings [rad] or [m], N x 4 x 4 of N x n."""
forward_kinematics = forwardKinematics

def readRobotYaml(file: _Path) -> Arm:
    """Reads robot.yaml."""
read_robot_yaml = readRobotYaml

def robotYaml(arm: Arm) -> str:
    """Text of robot.yaml."""
robot_yaml = robotYaml

def readUrdf(file: _Path, base_link: str, tip_link: str) -> Arm:
    """Reads the chain base_link .. tip_link of a URDF."""
read_urdf = readUrdf

def readArm(file: _Path, base_link: str = ..., tip_link: str = ...) -> Arm:
    """Reads robot.yaml or a URDF, whose links must then be named."""
read_arm = readArm

def correctedUrdf(urdf: _Path, base_link: str, tip_link: str, arm: Arm) -> str:
    """Text of the URDF with the geometry of `arm`; everything else in the file stays."""
corrected_urdf = correctedUrdf

def readCamera(file: _Path) -> Camera:
    """Reads a camera as ROS, OpenCV or Kalibr write it."""
read_camera = readCamera

def cameraYaml(camera: Camera) -> str:
    """Text of camera.yaml."""
camera_yaml = cameraYaml

def apriltagTarget(family: str, tags: Sequence[TargetTag]) -> Target: ...
apriltag_target = apriltagTarget

def chessboardTarget(cols: int, rows: int, square: float) -> Target: ...
chessboard_target = chessboardTarget

def charucoTarget(cols: int, rows: int, square: float, marker: float, dictionary: str) -> Target: ...
charuco_target = charucoTarget

def aprilgridTarget(
    family: str, cols: int, rows: int, tag_size: float, tag_spacing: float, first_id: int, border_bits: int = ...
) -> Target: ...
aprilgrid_target = aprilgridTarget

def pointsTarget(points: Sequence[TargetPoint]) -> Target: ...
points_target = pointsTarget

def readTarget(file: _Path) -> Target:
    """Reads target.yaml."""
read_target = readTarget

def targetYaml(target: Target) -> str:
    """Text of target.yaml."""
target_yaml = targetYaml

def sampleTable(
    q: ArrayLike = ..., *, T_base_flange: ArrayLike = ..., image: Sequence[str] = ..., pose: Sequence[int] = ..., stamp: ArrayLike = ...,
    temperature: ArrayLike = ..., payload: ArrayLike = ..., dir: ArrayLike = ..., dq: ArrayLike = ...,
    other: Mapping[str, ArrayLike] = ...
) -> SampleTable:
    """A table from columns with one row per sample: the members of SampleArrays as keywords."""
sample_table = sampleTable

def samplesCsv(table: SampleTable) -> str:
    """Text of samples.csv."""
samples_csv = samplesCsv

def readJointTable(file: _Path, arm: Arm) -> SampleTable:
    """Reads a table of joint readings for an arm."""
read_joint_table = readJointTable

def readWantedPoses(file: _Path, arm: Arm) -> SampleTable:
    """Reads a table of poses that the flange should go to."""
read_wanted_poses = readWantedPoses

def readPoses(file: _Path, arm: Arm) -> PoseTable:
    """Reads poses.csv for an arm."""
read_poses = readPoses

def predictCorners(cell: Cell, target: Target, T_base_flange: ArrayLike) -> list[Corner]:
    """Pixels of the target's points that the camera can see."""
predict_corners = predictCorners

def readCapture(folder: _Path) -> Capture:
    """Reads a capture folder and checks what can be checked without pictures."""
read_capture = readCapture

def effectKinds() -> list[EffectKind]:
    """All kinds of effects."""
effect_kinds = effectKinds

def effectKind(name: str) -> EffectKind: ...
effect_kind = effectKind

def makeEffect(spec: EffectSpec, cell: Cell) -> AppliedEffect:
    """The instance that a spec names; parameters left out are 0."""
make_effect = makeEffect

def readModel(file: _Path) -> Model:
    """Reads model.yaml."""
read_model = readModel

def modelYaml(model: Model) -> str:
    """Text of model.yaml."""
model_yaml = modelYaml

def realArm(model: Model) -> RealArm:
    """The arm of a model as it really moves."""
real_arm = realArm

def reachedPoses(arm: RealArm, commands: SampleTable) -> _Array:
    """T_base_flange that each command really reaches, effects included: N x 4 x 4."""
reached_poses = reachedPoses

def compensate(arm: RealArm, wanted: SampleTable, start_arm: Arm | None = ..., listener: Listener | None = ...) -> list[JointCommand]:
    """The joints to command so that the arm reaches T_base_flange of each row."""

def commandsCsv(wanted: SampleTable, commands: Sequence[JointCommand]) -> str:
    """Text of the table of commands."""
commands_csv = commandsCsv

def diagnosisText(diagnosis: Diagnosis, samples: Sequence[Sample], length: TextLength = ...) -> str:
    """The diagnosis in sentences."""
diagnosis_text = diagnosisText

def explainEffect(diagnosis: Diagnosis, effect: str) -> str:
    """Why an effect was or was not chosen."""
explain_effect = explainEffect

def readResults(folder: _Path) -> ResultSummary:
    """Reads the results in a folder; none of the files need be there."""
read_results = readResults

def fleetColumns() -> list[str]:
    """What a row of fleet.csv holds."""
fleet_columns = fleetColumns

def fleetRow(summary: ResultSummary) -> list[str]:
    """The cells of a row by their columns."""
fleet_row = fleetRow

def fleetText(results: Sequence[ResultSummary]) -> str:
    """The results of many captures as a table for people."""
fleet_text = fleetText

def fleetCsv(results: Sequence[ResultSummary]) -> str:
    """Text of fleet.csv."""
fleet_csv = fleetCsv

def fleetHtml(results: Sequence[ResultSummary], page: _Path) -> str:
    """The results of many captures as one page; `page` is where it will stand, for its links."""
fleet_html = fleetHtml

def registrationYaml(calibration: Calibration, measurements: Measurements) -> str:
    """Text of registration.yaml."""
registration_yaml = registrationYaml

def flangePosesCsv(calibration: Calibration, measurements: Measurements) -> str:
    """Text of flange_poses.csv."""
flange_poses_csv = flangePosesCsv

def identificationJson(identification: Identification, samples: Sequence[Sample]) -> str:
    """Text of identification.json."""
identification_json = identificationJson

def diagnosisJson(calibration: Calibration, measurements: Measurements) -> str:
    """Text of diagnosis.json."""
diagnosis_json = diagnosisJson

def registerCell(cell: Cell, observations: Sequence[Observation], options: RegistrationOptions = ...) -> RegistrationResult:
    """Finds where camera and target are, from the corners of pictures."""
register_cell = registerCell

def registerPoses(cell: Cell, observations: Sequence[Observation], robust: bool = ...) -> PoseRegistration:
    """Finds where an instrument and its tool are, from the poses that it measured."""
register_poses = registerPoses

def identify(
    cell: Cell, measurements: Measurements, options: IdentifyOptions = ..., registration: RegistrationResult | None = ...
) -> Identification:
    """Identifies the arm; `registration` is of these measurements, where it was done already."""

def diagnose(identification: Identification, measurements: Measurements, options: DiagnoseOptions = ...) -> Diagnosis:
    """Diagnoses what an identification of these measurements leaves."""

def calibrate(nominal: Cell, measurements: Measurements, options: CalibrateOptions = ...) -> Calibration:
    """Calibrates a cell from memory."""

def runCapture(
    source: CaptureSource | _Path, out: _Path, options: CalibrateOptions = ..., files: ResultFiles = ..., listener: Listener | None = ...
) -> CalibrationRun:
    """Calibrates a capture folder and writes the results into `out`."""
run_capture = runCapture

def runPoses(
    source: PosesSource, out: _Path, options: CalibrateOptions = ..., files: ResultFiles = ..., listener: Listener | None = ...
) -> CalibrationRun:
    """The same from poses of an instrument."""
run_poses = runPoses

def loadCapture(source: CaptureSource | _Path, out: _Path, jobs: int = ..., listener: Listener | None = ...) -> LoadedCapture:
    """Reads a capture; its intrinsics and corners are found where it names none."""
load_capture = loadCapture

def openCapture(source: CaptureSource | _Path) -> Capture:
    """Reads a capture folder with the files of `source` in their places."""
open_capture = openCapture

def writeResults(calibration: Calibration, measurements: Measurements, files: ResultFiles, out: _Path) -> None:
    """Writes what the calibration holds of these files into `out`."""
write_results = writeResults

def writeReport(run: CalibrationRun, capture: _Path, out: _Path, jobs: int = ..., listener: Listener | None = ...) -> str:
    """Writes report.json and report.html; says why there is no page, or nothing."""
write_report = writeReport

def renderReport(out: _Path, jobs: int = ..., listener: Listener | None = ...) -> None:
    """Writes report.html from report.json."""
render_report = renderReport

def reportJson(run: CalibrationRun, pictures: str) -> str:
    """Text of report.json; `pictures` is their folder as seen from its own; empty: none."""
report_json = reportJson

def reportBuilt() -> bool:
    """Whether this build can make pages."""
report_built = reportBuilt

def calibrateBoardFolder(
    folder: _Path, options: IntrinsicsOptions, jobs: int, camera_file: _Path, listener: Listener | None = ...
) -> IntrinsicsResult:
    """Finds the lens from the pictures of a board in a folder, and writes `camera_file`."""
calibrate_board_folder = calibrateBoardFolder

def checkCapture(folder: _Path, options: CheckOptions = ...) -> CaptureCheck:
    """Judges a capture before anything is fitted."""
check_capture = checkCapture

def createCapture(capture: NewCapture) -> list[Path]:
    """Makes a capture folder to fill in."""
create_capture = createCapture

def readDetections(file: _Path, target: Target) -> Detections:
    """Reads detections.csv."""
read_detections = readDetections

def detectionsCsv(detections: Detections) -> str:
    """Text of detections.csv."""
detections_csv = detectionsCsv

def picturesCsv(detections: Detections) -> str:
    """Text of detections-pictures.csv: a row for each picture that has a look."""
pictures_csv = picturesCsv

def readPictureLooks(file: _Path) -> list[PictureLook]:
    """Reads a table of looks, as picturesCsv() writes it."""
read_picture_looks = readPictureLooks

def medianLook(looks: Sequence[PictureLook]) -> PictureLook | None:
    """The median of each figure by itself; None where there are no looks."""
median_look = medianLook

@overload
def measurementsOf(table: PoseTable) -> Measurements:
    """The poses of an instrument."""

@overload
def measurementsOf(capture: Capture, detections: Detections) -> Measurements:
    """The corners of a capture, for calibrate()."""
measurements_of = measurementsOf

def calibrateIntrinsics(views: Sequence[BoardView], width: int, height: int, options: IntrinsicsOptions = ...) -> IntrinsicsResult:
    """Fits a camera and one board pose per picture."""
calibrate_intrinsics = calibrateIntrinsics

def detect(
    folder: _Path, images: Sequence[str], target: Target, options: DetectOptions = ..., known: KnownCorners | None = ...
) -> DetectResult:
    """Corners of the target in each of the pictures, which are named from the folder."""

def detectCapture(capture: Capture, options: DetectOptions = ..., known: KnownCorners | None = ...) -> DetectResult:
    """Corners of the target in the picture of every sample, and of the reference where there is one."""
detect_capture = detectCapture

def takeSizeFromPictures(capture: Capture) -> None:
    """Gives the camera of a file without a size that of the capture's first picture."""
take_size_from_pictures = takeSizeFromPictures

def readBoardPictures(folder: _Path, options: DetectOptions = ..., known: KnownCorners | None = ...) -> BoardPictures:
    """Finds the target of folder/target.yaml in every picture of the folder."""
read_board_pictures = readBoardPictures

def texts(notes: Sequence[PictureNote]) -> list[str]:
    """The picture and the message of each remark."""

def listPictures(folder: _Path) -> list[str]:
    """Names of a folder's pictures, sorted."""
list_pictures = listPictures

def knownFamilies() -> list[str]:
    """Families of tags that can be detected."""
known_families = knownFamilies

def readScene(file: _Path) -> Scene:
    """Reads scene.yaml."""
read_scene = readScene

def imageOptions(scene: Scene, index: int) -> ImageOptions:
    """How a scene's picture of this number is drawn."""
image_options = imageOptions

def drawSamples(scene: Scene, options: SimulateOptions = ...) -> SampleTable:
    """Joint readings of a scene [rad] or [m]: from its file, or drawn within the limits with the target in view."""
draw_samples = drawSamples

def trueCorners(scene: Scene, samples: SampleTable) -> list[ImageCorners]:
    """Exact corners at each sample [px], with the scene's effects."""
true_corners = trueCorners

def simulate(scene: Scene, capture: _Path, options: SimulateOptions = ...) -> SimulateSummary:
    """Writes the capture folder, and its truth beside it in the folder CAPTURE-truth."""

def renderTarget(
    camera: Camera, target: Target, T_camera_target: ArrayLike, options: ImageOptions = ..., seed: int = ..., stream: int = ...
) -> NDArray[np.uint8]:
    """A grey picture of the target, height x width of 0..255; seed and stream are of its background and noise."""
render_target = renderTarget

def readPlanningCell(source: PlanSource) -> PlanningCell:
    """What a plan starts from, of a capture with its results."""
read_planning_cell = readPlanningCell

def firstCapture(first: FirstCapture) -> PlanningCell:
    """What a plan of a whole first capture starts from."""
first_capture = firstCapture

def planPoses(cell: PlanningCell, options: PlanOptions = ...) -> Plan:
    """Chooses poses within the limits that show the target and touch nothing obvious."""
plan_poses = planPoses

def toolUncertainty(cell: PlanningCell, more: Sequence[Sample]) -> ToolUncertainty:
    """The uncertainty of the tool once corners are seen at these samples as well."""
tool_uncertainty = toolUncertainty

def planCsv(plan: Plan, taken: int = ...) -> str:
    """Text of next.csv; pictures are numbered on from `taken`."""
plan_csv = planCsv

def dhTables(nominal: Arm, calibrated: Arm) -> DhTables:
    """Both arms by their parameters, which compare row by row."""
dh_tables = dhTables

def dhForward(table: DhTable, arm: Arm, q: ArrayLike) -> _Array:
    """T_base_flange(q) by the table: 4 x 4 of n readings [rad] or [m], N x 4 x 4 of N x n. `arm` says which joints slide."""
dh_forward = dhForward

def dhYaml(tables: DhTables, arm: Arm) -> str:
    """Text of dh.yaml."""
dh_yaml = dhYaml

def frameNames(model: Model) -> FrameNames:
    """base" and "flange", or the links of the model's URDF."""
frame_names = frameNames

def cameraInfoYaml(model: Model) -> str:
    """Text of ROS's camera_info file."""
camera_info_yaml = cameraInfoYaml

def transformsYaml(model: Model, names: FrameNames) -> str:
    """Text of the cell's two fixed transforms, both ways, for tf2."""
transforms_yaml = transformsYaml

def jointTableCsv(model: Model, nominal: Arm) -> str:
    """Text of a table with a row per joint."""
joint_table_csv = jointTableCsv

def paperNamed(name: str) -> Paper:
    """a4" .. "a0", "letter", "legal", "tabloid", or WIDTHxHEIGHT in millimetres."""
paper_named = paperNamed

def drawTargetSheet(target: Target, paper: Paper) -> TargetSheet:
    """Draws a target in its size with two rulers; the same target and paper give the same bytes."""
draw_target_sheet = drawTargetSheet

def paperPoses(actual: Arm, options: PaperOptions = ..., seed: int = ...) -> PoseTable:
    """The measured poses of one seed."""
paper_poses = paperPoses

def paperExperiment(nominal: Arm, actual: Arm, options: PaperOptions = ...) -> list[PaperSeed]:
    """The paper's methods `gao` and `weighted` side by side, for seeds 1 to options.seeds."""
paper_experiment = paperExperiment
