"""A reason of a check, in English and in Chinese."""

REASON = (
    'expected 5.0 Hz on /kinematics/joint_states, saw 1.0 Hz over 10 s (10 messages): '
    'the timer period is in seconds, and period = 1 / rate'
)
CHINESE_REASON = (
    '预期：/kinematics/joint_states 的频率为 5.0 Hz；实际：10 s 内为 1.0 Hz（10 条消息）。'
    '定时器的周期以秒为单位，周期 = 1 / 频率'
)
