"""Meshes: the bundled heads, mesh files, lips, jaw, and the deformers that tie vertices to markers."""

from corpus_tools.mesh.attachment import Attachment
from corpus_tools.mesh.binding import Binding, LinearBinding, PatchBinding
from corpus_tools.mesh.bundle import CHARACTERS, bundled_head, bundled_morph_mm, bundled_morphs
from corpus_tools.mesh.chart import CONTROL_POINTS, Chart, open_mouth_chart
from corpus_tools.mesh.checking import (
    MeshFault,
    boundary_loops,
    check_mesh,
    closing_faces,
    inner_lip_ring,
    refuse_fatal,
)
from corpus_tools.mesh.deform import ATTACHMENTS, DEFORMERS, bind_bid, bind_linear, bind_rbf
from corpus_tools.mesh.falloff import STILL_MARKERS
from corpus_tools.mesh.files import (
    UNITS_MM,
    mesh_by_name_or_file,
    read_mesh,
    read_picks,
    read_surface,
    unit_of_extent,
    write_mesh,
)
from corpus_tools.mesh.jaw import JAW_PARTS, jaw_hinge_mm, jaw_motion
from corpus_tools.mesh.landmarks import FaceLandmarks, find_landmarks
from corpus_tools.mesh.lips import LOWER_LIP, UPPER_LIP, close_lips, lower_side, signed_lip_aperture_mm
from corpus_tools.mesh.neck import level_neck, neck_rim, with_level_neck
from corpus_tools.mesh.proposal import open_lips, propose_markers, ready_to_speak
from corpus_tools.mesh.rbf import DISPLACEMENT_KERNELS, displacement_basis
from corpus_tools.mesh.regions import SkinRegion, skin_regions
from corpus_tools.mesh.surface import ControlSurface
from corpus_tools.mesh.topology import edge_loop, edges_of, geodesic_mm, triangles, vertex_normals

__all__ = [
    "ATTACHMENTS",
    "CHARACTERS",
    "CONTROL_POINTS",
    "DEFORMERS",
    "DISPLACEMENT_KERNELS",
    "JAW_PARTS",
    "LOWER_LIP",
    "STILL_MARKERS",
    "UNITS_MM",
    "UPPER_LIP",
    "Attachment",
    "Binding",
    "Chart",
    "ControlSurface",
    "FaceLandmarks",
    "LinearBinding",
    "MeshFault",
    "PatchBinding",
    "SkinRegion",
    "bind_bid",
    "bind_linear",
    "bind_rbf",
    "boundary_loops",
    "bundled_head",
    "bundled_morph_mm",
    "bundled_morphs",
    "check_mesh",
    "close_lips",
    "closing_faces",
    "displacement_basis",
    "edge_loop",
    "edges_of",
    "find_landmarks",
    "geodesic_mm",
    "inner_lip_ring",
    "jaw_hinge_mm",
    "jaw_motion",
    "level_neck",
    "lower_side",
    "mesh_by_name_or_file",
    "neck_rim",
    "open_lips",
    "open_mouth_chart",
    "propose_markers",
    "read_mesh",
    "read_picks",
    "read_surface",
    "ready_to_speak",
    "refuse_fatal",
    "signed_lip_aperture_mm",
    "skin_regions",
    "triangles",
    "unit_of_extent",
    "vertex_normals",
    "with_level_neck",
    "write_mesh",
]
