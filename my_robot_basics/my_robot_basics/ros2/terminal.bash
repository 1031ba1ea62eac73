# shellcheck shell=bash
# What bash reads in JupyterLab's terminal and in ./course ros-shell: the user's own ~/.bashrc, then the
# course's settings again, over what that may have set for another ROS or another Python.
course_settings=$(export -p)
# shellcheck disable=SC1090
[ ! -f ~/.bashrc ] || . ~/.bashrc
course_path=$VIRTUAL_ENV/bin:$PATH
unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH COLCON_PREFIX_PATH CMAKE_PREFIX_PATH
unset ROS_DISTRO ROS_VERSION ROS_PYTHON_VERSION ROS_DOMAIN_ID ROS_LOCALHOST_ONLY ROS_DISCOVERY_SERVER
unset ROS_STATIC_PEERS ROS_SECURITY_ENABLE RMW_IMPLEMENTATION FASTDDS_BUILTIN_TRANSPORTS
eval "$course_settings"
PATH=$course_path
eval "$(register-python-argcomplete ros2)"
eval "$(register-python-argcomplete topic_doctor)"
unset course_settings course_path
