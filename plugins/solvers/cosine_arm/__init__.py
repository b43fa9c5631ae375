"""The three-axis arm of source 004: base yaw, shoulder and elbow by the law of cosines."""
