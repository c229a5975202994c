"""Paper A, from its data to its future work: what it says of its method, in its order, and the test of each.

Equations (1) to (3), the selection algorithm, the grammar, figures 2 to 5, and what the paper calls future
work and we built. What it leaves open, and what we chose for which reason, is
decision 013.
"""

# ruff: noqa: F401, I001  imported for pytest to run, in the order of the paper

from __future__ import annotations

import importlib
import pkgutil
from pathlib import Path

from tests.papers import paper_a

# 4  Data Description
# "66 markers ... plus 7 more on a head mounted jig", "120Hz", "fifty-five sentences", the time grammar
from tests.papers.paper_a.corpus import (
    test_it_is_captured_as_in_the_paper,
    test_the_demo_has_fifty_five_sentences,
    test_the_grammar_has_2880_sentences_exactness_and_minutes_being_optional,
    test_it_holds_the_examples_of_the_paper_which_the_strict_reading_excludes,
)

# "Kalman filtering is used to remove noise", "resampling of the DCT is used to reconstruct the missing data",
# "rigid head motion is also removed ... jig and a least-squares approach", "initially spatially aligned"
from tests.papers.paper_a.preprocessing import (
    simulated,
    test_kalman_filtering_removes_noise,
    test_resampling_of_the_cosine_transform_reconstructs_missing_data,
    test_missing_segments_are_reconstructed_and_stay_marked,
    test_rigid_motion_is_removed_by_the_jig_and_least_squares,
    test_jig_and_least_squares_together_survive_a_slip_that_the_jig_alone_does_not,
    test_a_jig_that_slips_far_is_no_longer_believed,
    test_afterwards_the_motions_are_spatially_aligned,
)

# 5.1  Visual Speech Fragments
# "diphone, syllable, word, and sentence fragments are extracted",
# "larger fragments produce more natural animation"
from tests.papers.paper_a.units import (
    test_every_sentence_and_every_diphone_of_the_recordings_is_a_unit,
    test_words_are_units_from_the_first_phone_to_the_last,
    test_syllables_are_units_within_their_word,
    test_larger_fragments_leave_fewer_joins_than_diphones_alone,
)

# 5.1.1  Unit Selection
# the pseudo-code, "chooses fragments of longer duration", "similarity in the phonetic timing ... of context"
from tests.papers.paper_a.selection import (
    test_the_printed_algorithm_ends_and_equals_the_mended_one_when_every_diphone_is_there,
    test_the_printed_algorithm_never_ends_when_a_diphone_is_missing,
    test_nor_does_it_where_single_phones_are_no_units,
    test_the_mended_algorithm_names_the_missing_diphone_or_has_its_class_stand_in,
    test_longer_fragments_come_first,
    test_equal_fragments_are_told_apart_by_their_timing,
    test_equal_fragments_are_told_apart_by_their_context,
    test_neighbouring_fragments_share_a_phone,
)

# 5.1.2  Alignment and Resampling of Speech Fragments
# "labels are correctly aligned", "consistent frame-rate"
from tests.papers.paper_a.alignment import (
    test_the_labels_are_correctly_aligned_with_the_target,
    test_evenly_distributed_samples_between_repositioned_labels,
    test_the_frame_rate_is_consistent,
    test_reading_the_source_clock_is_far_more_accurate_than_moving_the_samples,
)

# equation (1): "a linear combination of n basis functions ... and a polynomial term", inverse multiquadrics
from tests.papers.paper_a.equations import (
    test_eq_1_is_the_sum_of_basis_functions_and_a_polynomial,
    test_eq_1_interpolates_every_centre_exactly,
    test_eq_1_the_weights_annihilate_the_polynomial,
    test_eq_1_the_curve_is_smooth_at_the_centres,
)

# 5.1.3  Blending Motions
# equation (2), figure 3, "a fraction of the smallest phone-to-phone interval",
# "a couple of frames overlap at each join" at 30 fps, "a small degree of context is required"
from tests.papers.paper_a.equations import test_eq_2_weighs_the_two_fragments_of_every_overlap
from tests.papers.paper_a.blending import (
    test_equation_2_blends_two_fragments_by_g_of_u,
    test_figure_3_the_weighting_functions_are_different_curves,
    test_the_speed_of_decay_says_how_fast_the_second_fragment_is_faded_in,
    test_only_the_overlapping_regions_are_blended,
    test_the_overlap_is_always_a_fraction_of_the_smallest_phone_interval,
    test_at_30_frames_a_second_a_couple_of_frames_overlap_and_at_120_four_times_as_many,
    test_a_small_degree_of_context_is_enough,
    test_peak_acceleration_of_the_weightings,
    test_a_longer_overlap_calms_every_weighting,
)

# 6  Retargetting and Animation
# "f : R3 -> R3", "a mesh may vary in shape, scale and orientation", "relative to the neutral pose"
from tests.papers.paper_a.retarget import (
    actor,
    test_the_warp_maps_the_neutral_pose_to_the_target_mesh,
    test_a_mesh_may_vary_in_scale_and_orientation,
    test_where_the_actor_stands_and_how_large_he_is_does_not_matter,
    test_frames_are_retargetted_relative_to_the_neutral_pose,
    test_characters_keep_their_own_shape,
    test_the_lips_move_entirely_independently,
    test_closed_lips_never_pass_through_each_other,
)

# equation (3), figure 4: "a triangulation of the motion captured points", "continuity conditions at patch
# boundaries", "thresholding the maximum angle", lips "able to move entirely independently"
from tests.papers.paper_a.bids import (
    test_eq_3_a_vertex_is_the_point_of_its_patch_plus_d_times_the_unit_normal,
    test_eq_3_is_not_linear_in_the_markers,
    test_the_deformer_surface_is_a_triangulation_of_the_markers,
    test_the_lips_move_entirely_independently_with_every_patch_deformer,
    test_the_angle_threshold_is_the_papers_attachment,
)

# 7  Results
# "the movement of the skin in the cheeks",
# "the jaw is determined directly from the motion of captured points on the skin covering the jaw"
from tests.papers.paper_a.results import (
    test_the_skin_of_the_cheeks_moves_with_speech,
    test_the_jaw_is_determined_from_points_on_the_skin_that_covers_it,
    test_lower_teeth_and_tongue_go_with_the_jaw_and_upper_teeth_stay,
)

# 8  Conclusions
# "capture once and ... animate several characters", boundary conditions in selection, backoff
from tests.papers.paper_a.retarget import test_one_capture_opens_and_rounds_the_mouth_of_every_character
from tests.papers.paper_a.future import (
    test_units_of_like_boundary_conditions_are_preferred,
    test_units_of_sound_and_motion_are_chosen_together,
    test_backoff_merges_captured_fragments_with_what_stands_in,
)

# statement -> where it is tested, because the test needs a browser, drawing, or a fixture of its folder
ELSEWHERE = {
    '4 "this corpus can be used to generate" / 5.1 "to resynthesize any sentence from the time domain"': (
        "demo/test_demo_coverage.py",
        "test_all_2880_have_every_diphone_in_the_corpus_so_that_none_needs_backoff",
    ),
    '4 "captured simultaneously ... synchronized with the motion data"': (
        "demo/test_demo_sound.py",
        "test_sound_is_as_long_as_the_phones_and_within_range",
    ),
    "figure 2, motion trajectories over time": (
        "browser/test_page_reach.py",
        "test_trajectories_say_that_they_are_drawn_and_follow_the_theme",
    ),
    "figure 3, live: a weighting function is chosen, drawn and dragged": (
        "browser/test_page.py",
        "test_a_dragged_handle_makes_an_own_curve_and_keys_move_it",
    ),
    "figure 4, captured points and control surface on the head": (
        "browser/test_widget_face.py",
        "test_overlays_appear_on_demand_move_and_go",
    ),
    '6 "continuity conditions at patch boundaries"': (
        "mesh/test_mesh_patches.py",
        "test_is_smooth_however_the_markers_move",
    ),
    '6 "maintain discontinuities in the target mesh"': (
        "mesh/test_mesh_patches.py",
        "test_uses_every_marker_and_never_joins_the_lips",
    ),
    "figure 5, frames and vertex trajectories of an animation": (
        "render/test_render_strip.py",
        "test_the_figure_names_its_axes_and_draws_what_was_synthesised",
    ),
    '7 "can be implemented in real-time": measured, never a reason to fail': (
        "benchmarks/test_stage_speed.py",
        "test_deform",
    ),
}


def test_what_stands_elsewhere_is_there():
    for statement, (file, test) in ELSEWHERE.items():
        text = (Path(__file__).parents[1] / file).read_text(encoding="utf-8")
        assert f"def {test}(" in text, statement


def test_nothing_of_the_parts_is_left_out():
    here = set(globals())
    for part in pkgutil.iter_modules(paper_a.__path__):
        module = importlib.import_module(f"tests.papers.paper_a.{part.name}")
        missing = {name for name in vars(module) if name.startswith("test_")} - here
        assert not missing, (part.name, missing)
