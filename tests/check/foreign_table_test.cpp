// Columns of other programs: named by the user, recognised, or left as they are.
#include "check/foreign_table.h"

#include <gtest/gtest.h>

#include <cmath>

#include "motion/trajectory_csv.h"
#include "text/message.h"

namespace polhode {
namespace {

TEST(ForeignTable, ColumnsOfTheUsersOwn) {
    const ColumnNames names =
        parse_columns("time=clock,rotation=a:b:c:d,angular_velocity=u:v:w,position=x:y:z,velocity=k:l:m");
    const ForeignTable table =
        own_columns("clock,note,a,b,c,d,u,v,w,x,y,z,k,l,m\n0,hello,0.1,0.2,0.3,0.9,1,2,3,4,5,6,7,8,9\n", "f", names);
    const TrajectoryFile file = parse_trajectory(table.text, "f");
    ASSERT_EQ(file.rows.size(), 1U);
    EXPECT_EQ(file.rows[0].q, (Quaternion<double>{0.9, 0.1, 0.2, 0.3}));
    EXPECT_EQ(file.rows[0].angular_velocity_W, (Vector3<double>{1, 2, 3}));
    EXPECT_EQ(file.rows[0].position_W, (Vector3<double>{4, 5, 6}));
    EXPECT_EQ(file.rows[0].velocity_W, (Vector3<double>{7, 8, 9}));
    ASSERT_EQ(table.remarks.size(), 2U);
    EXPECT_NE(table.remarks[1].find("note"), std::string::npos);
}

TEST(ForeignTable, NamesInCommonUseAreKnown) {
    for (const char* header :
         {"Time,Rotation.x,Rotation.y,Rotation.z,Rotation.w", "timestamp,quat_x,quat_y,quat_z,quat_w", "T,QX,QY,QZ,QW",
          "time,orientation_x,orientation_y,orientation_z,orientation_w"}) {
        const ForeignTable table = own_columns(std::string(header) + "\n0.5,0.1,0.2,0.3,0.9\n", "f", {});
        const TrajectoryFile file = parse_trajectory(table.text, "f");
        EXPECT_EQ(file.rows[0].t, 0.5) << header;
        EXPECT_EQ(file.rows[0].q, (Quaternion<double>{0.9, 0.1, 0.2, 0.3})) << header;
    }
}

TEST(ForeignTable, AMatrixRowByRow) {
    // a quarter turn about z
    const ForeignTable table = own_columns("t,a,b,c,d,e,f,g,h,i\n0,0,-1,0,1,0,0,0,0,1\n", "f",
                                           parse_columns("time=t,rotation=a:b:c:d:e:f:g:h:i"));
    const Quaternion<double> q = parse_trajectory(table.text, "f").rows[0].q;
    EXPECT_NEAR(q.w, std::sqrt(0.5), 1e-15);
    EXPECT_NEAR(q.z, std::sqrt(0.5), 1e-15);
    EXPECT_THROW(own_columns("t,a,b,c,d,e,f,g,h,i\n0,0,-1,0,1,0,0,0,0,-1\n", "f",
                             parse_columns("time=t,rotation=a:b:c:d:e:f:g:h:i")),
                 InputError);
}

TEST(ForeignTable, AMatrixColumnByColumn) {
    const ForeignTable table = own_columns("t,a,b,c,d,e,f,g,h,i\n0,0,1,0,-1,0,0,0,0,1\n", "f",
                                           parse_columns("time=t,matrix_by_columns=a:b:c:d:e:f:g:h:i"));
    EXPECT_NEAR(parse_trajectory(table.text, "f").rows[0].q.z, std::sqrt(0.5), 1e-15);
}

// against the turns by hand: yaw 90 degrees takes x to y; then pitch 90 about the new y, which is -x
TEST(ForeignTable, EulerAnglesOfANamedSequence) {
    ColumnNames names = parse_columns("time=t,euler_zyx=yaw:pitch:roll");
    names.degrees = true;
    const ForeignTable table = own_columns("t,roll,pitch,yaw\n0,0,90,90\n", "f", names);
    const Quaternion<double> q = parse_trajectory(table.text, "f").rows[0].q;
    EXPECT_LT(angle_between(rotate(q, Vector3<double>(1, 0, 0)), Vector3<double>(0, 0, -1)), 1e-15);
    EXPECT_LT(angle_between(rotate(q, Vector3<double>(0, 1, 0)), Vector3<double>(-1, 0, 0)), 1e-15);
    EXPECT_THROW(parse_columns("time=t,euler_zzx=a:b:c"), std::invalid_argument);
    EXPECT_THROW(own_columns("t,a,b,c\n0,1,x,2\n", "f", parse_columns("time=t,euler_xyz=a:b:c")), InputError);
}

TEST(ForeignTable, OwnAndUnknownTablesStayAsTheyAre) {
    for (const char* text : {"t,qw,qx,qy,qz\n0,1,0,0,0\n", "a,b,c\n1,2,3\n", "", "t,qw,qx,qy\n0,1,0,0\n"})
        EXPECT_EQ(own_columns(text, "f", {}).text, text);
}

TEST(ForeignTable, SlipsAreNamed) {
    for (const char* words : {"", "time", "time=", "time=a:b", "rotation=a:b:c", "speed=a:b:c", "time=t,time=u"})
        EXPECT_THROW(parse_columns(words), std::invalid_argument) << words;
    EXPECT_THROW(own_columns("a,b\n1,2\n", "f", parse_columns("time=t")), InputError);
    EXPECT_THROW(own_columns("Time,qx,qy,qz,qw\n1,2\n", "f", {}), InputError);
}

}  // namespace
}  // namespace polhode
