// A program with CycloneDDS 0.10 (Debian 12, Ubuntu, the line of ROS Humble to Jazzy) that has
// typed endpoints on the operation mode, type information included. It publishes the mode 7 and
// prints "received MODE" for each sample of others, and "matched READERS WRITERS" on changes.
// Arguments: the domain, the topic, and "ros" or "plain" for the name of the type.
// Ends when its standard input closes.
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "dds/dds.h"
#include "operation_mode.h"

typedef autoware_adapi_v1_msgs_msg_dds__OperationModeState_ mode_t_;

static dds_entity_t topic_of (dds_entity_t participant, const char *name, const char *naming)
{
  const dds_topic_descriptor_t *type = strcmp (naming, "ros") == 0
    ? &autoware_adapi_v1_msgs_msg_dds__OperationModeState__desc
    : &autoware_adapi_v1_msgs_msg_OperationModeState_desc;
  return dds_create_topic (participant, type, name, NULL, NULL);
}

static dds_qos_t *policies (void)
{
  dds_qos_t *qos = dds_create_qos ();
  dds_qset_reliability (qos, DDS_RELIABILITY_RELIABLE, DDS_MSECS (100));
  dds_qset_durability (qos, DDS_DURABILITY_TRANSIENT_LOCAL);
  dds_qset_ignorelocal (qos, DDS_IGNORELOCAL_PARTICIPANT);
  return qos;
}

static void print_received (dds_entity_t reader)
{
  void *samples[1] = { NULL };
  dds_sample_info_t info;
  while (dds_take (reader, samples, &info, 1, 1) > 0)
  {
    if (info.valid_data)
      printf ("received %d\n", ((mode_t_ *) samples[0])->mode);
    dds_return_loan (reader, samples, 1);
  }
}

int main (int count, char **arguments)
{
  if (count != 4)
    return 2;
  dds_entity_t participant = dds_create_participant (atoi (arguments[1]), NULL, NULL);
  dds_entity_t topic = topic_of (participant, arguments[2], arguments[3]);
  dds_qos_t *qos = policies ();
  dds_entity_t reader = dds_create_reader (participant, topic, qos, NULL);
  dds_entity_t writer = dds_create_writer (participant, topic, qos, NULL);
  dds_delete_qos (qos);
  if (reader < 0 || writer < 0)
    return 1;
  mode_t_ mode = { .mode = 7, .is_autoware_control_enabled = true };
  struct pollfd input = { .fd = 0, .events = POLLIN };
  int readers = -1, writers = -1;
  while (poll (&input, 1, 20) == 0)
  {
    int r = dds_get_matched_subscriptions (writer, NULL, 0);
    int w = dds_get_matched_publications (reader, NULL, 0);
    if (r != readers || w != writers)
      printf ("matched %d %d\n", readers = r, writers = w);
    mode.stamp.nanosec++;
    dds_write (writer, &mode);
    print_received (reader);
    fflush (stdout);
  }
  dds_delete (participant);
  return 0;
}
