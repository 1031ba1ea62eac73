"""A reason of a check, in English and in Chinese."""


# --- where they are shown ------------------------------------------------------------------------

REASON = (
    'expected 5.0 Hz, saw 1.0 Hz over 10 s (10 messages): '
    'the timer period is in seconds, and period = 1 / rate'
)
CHINESE_REASON = (
    '预期：5.0 Hz；实际：1.0 Hz，10 s 内（10 条消息）。定时器的周期以秒为单位，周期 = 1 / 频率'
)
