"""Names of topics and services as users type them."""


def full_name(text: str) -> str:
    """Return the full name, with its leading slash; raises ValueError for an invalid name."""
    from rclpy.exceptions import InvalidTopicNameException
    from rclpy.validate_full_topic_name import validate_full_topic_name

    if not isinstance(text, str):
        raise ValueError(
            f'{text!r:.60} is not a text: expected the name of a topic or a service, such as '
            "'/kinematics/joint_states'"
        )
    name = text if text.startswith('/') else f'/{text}'
    try:
        validate_full_topic_name(name)
    except InvalidTopicNameException as error:
        reason = str(error).splitlines()[0].rstrip(':. ')
        raise ValueError(
            f'{text!r} is not the name of a topic or a service ({reason}): expected one'
            ' such as /kinematics/joint_states'
        ) from None
    return name
