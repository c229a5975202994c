import panel as pn

from workbench.views.prompt import prompt


def test_a_prompt_widget_is_heard_at_once_and_its_kind_is_left_alone():
    slider = prompt(pn.widgets.FloatSlider(start=0, end=1))
    assert "value" in slider._priority_changes
    assert "value" not in pn.widgets.FloatSlider(start=0, end=1)._priority_changes
    both = prompt(pn.widgets.FloatSlider(), "value", "value_throttled")
    assert {"value", "value_throttled"} <= set(both._priority_changes)
